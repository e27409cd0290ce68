"""Tables of figures as Markdown, for pages of docs/."""


def print_table(title, head, rows):
    """Prints a title and a table. head, and each of rows: texts, one a column."""
    print(f"\n{title}\n\n| {' | '.join(head)} |\n| {' | '.join('---' for _ in head)} |")
    for row in rows:
        print(f"| {' | '.join(row)} |", flush=True)
