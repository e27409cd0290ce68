"""The clang tools that check the sources, of the version that they are written for."""
import re
import shutil
import subprocess

MAJOR = "14"  # Debian 12's; others format some lines differently and have other checks


def find_tool(name):
    """The command of a clang tool of this version, or None."""
    for command in (f"{name}-{MAJOR}", name):
        if shutil.which(command):
            version = subprocess.run([command, "--version"], capture_output=True, text=True).stdout
            if re.search(rf"version {MAJOR}\.", version):
                return command
    return None
