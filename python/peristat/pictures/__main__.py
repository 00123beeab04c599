"""The command `./peristat plot`; it runs as a file, without any installed package.

With `-` for the folder, it reads the folder's name from standard input when all libraries are loaded, and can be interrupted
from then on: `./peristat run` starts it before the folder exists. Without a name there is nothing to draw.
"""

import os
import signal
import sys
from pathlib import Path

os.environ["OMP_NUM_THREADS"] = "1"  # threads of libraries would keep the pictures from being drawn in several processes

if not __package__:
    sys.path[0] = str(Path(__file__).resolve().parents[2])

from peristat._folder_command import guarded
from peristat.pictures.command import main

words = sys.argv[1:]
if words == ["-"]:
    words = sys.stdin.readline().splitlines()
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGTSTP, signal.SIG_DFL)
    if not words:
        sys.exit()
sys.exit(guarded("plot", main, words))
