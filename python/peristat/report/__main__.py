"""The command `./peristat report`; it runs as a file, without any installed package."""

import sys
from pathlib import Path

if not __package__:
    sys.path[0] = str(Path(__file__).resolve().parents[2])

from peristat._folder_command import guarded
from peristat.report.command import main

sys.exit(guarded("report", main, sys.argv[1:]))
