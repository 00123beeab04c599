"""peristat: implicit quasi-static peridynamics. Docstrings are in the modules."""

from .body import Body as Body
from .case import Case as Case
from .case import Check as Check
from .case import load_case as load_case
from .dial import Dial as Dial
from .errors import InputError as InputError
from .errors import MachineError as MachineError
from .errors import MemoryError as MemoryError
from .fitting.api import Fit as Fit
from .fitting.api import fit as fit
from .law import sampled_law as sampled_law
from .points import Points as Points
from .results import Results as Results
from .results import open_results as open_results
from .run import Run as Run
from .run import resume as resume
from .steps import Step as Step
from .steps import Steps as Steps
from .sweeping import Sweep as Sweep
from .sweeping import sweep as sweep

NAMES: dict[str, str]

def versions() -> dict[str, str]:
    """Versions of peristat, its libraries and its compiler, by name."""
