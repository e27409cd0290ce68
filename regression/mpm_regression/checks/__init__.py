"""Answers that several cases share: exact values, set-ups and rows."""
