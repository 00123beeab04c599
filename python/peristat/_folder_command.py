"""What commands that read results folders share: exit codes, messages, what folders may cause, a process of their own."""

import os
import sys
import traceback
from collections.abc import Callable

from .errors import InputError

DONE, BUG, WRONG_INPUT, MACHINE_FAILED, INTERRUPTED = 0, 1, 2, 5, 130


def told(command: str, sentence: str, code: int) -> int:
    """Prints one line on standard error; returns the code."""
    line = "".join(c if c.isprintable() else " " for c in sentence)
    print(f"{command}: {line if len(line) < 1000 else line[:1000] + '…'}", file=sys.stderr)
    return code


def exit_code_of(
    command: str, folder: object, verb: str, refusals: tuple[type[Exception], ...], work: Callable[[], None]
) -> int:
    """Works with a folder; returns the exit code. `verb`: what can't be done with an edited folder."""
    try:
        work()
    except (InputError, *refusals) as error:
        return told(command, str(error), WRONG_INPUT)
    except OSError as error:
        return told(command, f"{folder}: {error}", MACHINE_FAILED)
    except NameError:  # a fault of the program: no folder's content causes it
        traceback.print_exc()
        return told(command, f"{folder}: a fault of the program, which is worth a report", BUG)
    except Exception as error:  # an unforeseen change in a folder that somebody has edited
        return told(command, f"{folder}: can't be {verb} ({type(error).__name__}: {error})", WRONG_INPUT)
    return DONE


def guarded(command: str, main: Callable[[list[str]], int], words: list[str]) -> int:
    """Runs `main` in a process of its own, because the HDF5 library may crash on a damaged file."""
    child = os.fork()
    if child == 0:
        try:
            code = main(words)
            sys.stdout.flush()
        except KeyboardInterrupt:
            code = INTERRUPTED
        except OSError:  # nobody reads the output
            code = MACHINE_FAILED
        os._exit(code)
    try:
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    except KeyboardInterrupt:  # from the terminal; the child has received it, too
        return INTERRUPTED
    if code >= 0:
        return code
    return told(command, f"reading {' '.join(words)} ended with signal {-code}: it is damaged", WRONG_INPUT)
