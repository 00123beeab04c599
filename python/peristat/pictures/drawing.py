"""A picture that a results folder allows, and that is drawn once it is asked for."""

from collections.abc import Callable
from dataclasses import dataclass

from .style import SCREEN, Picture, Style, own_settings


@dataclass(frozen=True)
class Drawing:
    """Name of a picture, and the function that draws it."""

    name: str
    make: Callable[[], Picture]
    of_step: bool = False  # it shows one step, rather than the whole run

    def figure(self, style: Style = SCREEN) -> Picture:
        with own_settings(style):
            return self.make()
