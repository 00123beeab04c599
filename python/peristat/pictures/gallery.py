"""The folder of pictures: which files are written there, and which may be removed.

`plots/.pictures` lists the pictures that were drawn, one name per line. Only these are ever removed, by the
next drawing and by the next run. Links are never followed: pictures go into the folder itself.
"""

import os
import re
import stat
from pathlib import Path

LIST = ".pictures"
SCRIPT = "show_in_paraview.py"
PICTURE_NAME = re.compile(rf"[A-Za-z0-9_]+\.(png|pdf|svg|gif)|{re.escape(SCRIPT)}")
OF_ONE_FIELD = re.compile(r"_step_\d{6}")
MOST_BYTES = 1_000_000  # size limit of the list


class NoPlace(Exception):
    """`plots` is not a folder, or a picture's name is taken by another file."""


class Gallery:
    """The folder `plots` of a results folder; it is created if missing.

    Raises NoPlace if the folder or its list is a link or another kind of file, OSError if it can't be written.
    """

    def __init__(self, results: Path):
        self.path = results / "plots"
        try:
            os.mkdir(self.path)
        except FileExistsError:
            pass
        self._require(self.path, stat.S_ISDIR, "a folder")
        self._folder = os.open(self.path, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
        if os.path.lexists(self.path / LIST):
            self._require(self.path / LIST, stat.S_ISREG, "a file")
        self.names = self._listed()

    @staticmethod
    def _require(path: Path, is_kind, kind: str) -> None:
        status = os.lstat(path)
        if stat.S_ISLNK(status.st_mode):
            raise NoPlace(f"{path} is a link, which is not followed; remove it to have pictures")
        if not is_kind(status.st_mode):
            raise NoPlace(f"{path} is not {kind}; remove it to have pictures")

    def _listed(self) -> list[str]:
        try:
            file = os.open(LIST, os.O_RDONLY | os.O_NOFOLLOW, dir_fd=self._folder)
        except FileNotFoundError:
            return []
        with os.fdopen(file, "rb") as lines:
            names = lines.read(MOST_BYTES).decode(errors="replace").splitlines()
        return list(dict.fromkeys(name for name in names if PICTURE_NAME.fullmatch(name)))

    def remove_earlier(self, endings: tuple[str, ...]) -> None:
        """Removes the listed pictures whose names end like this, except those that have become links, and pictures of one
        field, which somebody has asked for by name."""
        kept = []
        for name in self.names:
            if not name.endswith(endings) or OF_ONE_FIELD.search(name):
                kept.append(name)
                continue
            try:
                if stat.S_ISREG(os.stat(name, dir_fd=self._folder, follow_symlinks=False).st_mode):
                    os.unlink(name, dir_fd=self._folder)
            except FileNotFoundError:
                pass
        self.names = kept
        self._write(LIST, self._text())

    def add(self, name: str, content: bytes) -> None:
        """Writes a picture in place of an earlier drawing, and lists it.

        Raises NoPlace if an unlisted file has that name; a link is replaced.
        """
        if name not in self.names:
            self.names = list(dict.fromkeys([*self._listed(), *self.names]))  # another plot may be at work here
        if name not in self.names:
            if os.path.lexists(self.path / name) and not os.path.islink(self.path / name):
                raise NoPlace(f"{self.path / name} was not drawn by this command and would be replaced; move it "
                              "to have the picture")  # fmt: skip
            self.names.append(name)
            self._write(LIST, self._text())  # before the picture, so that every picture is on the list
        self._write(name, content)

    def _text(self) -> bytes:
        return "".join(name + "\n" for name in self.names).encode()

    def _write(self, name: str, content: bytes) -> None:
        """Writes a complete new file in one rename, which replaces a link and leaves its target alone."""
        unfinished = f".{name}.tmp"
        try:
            os.unlink(unfinished, dir_fd=self._folder)
        except FileNotFoundError:
            pass
        flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW
        with os.fdopen(os.open(unfinished, flags, 0o666, dir_fd=self._folder), "wb") as file:
            file.write(content)
        os.replace(unfinished, name, src_dir_fd=self._folder, dst_dir_fd=self._folder)
