"""The instances that a campaign names: bundled ones, files, and patterns of file names, found before anything is run."""

import fnmatch
import hashlib
import os
import re
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...instances.bundled import bundled_names, bundled_path
from ...instances.errors import InputError, UsageError
from ...instances.generating import generate
from ...instances.suggestions import did_you_mean
from ...instances.writing import write_instance
from .setting import canonical, short_hash

_PATTERN = "*?["


@dataclass(frozen=True)
class Named:
    """An instance as a campaign names it: a bundled one, or a file as the campaign says it, whose name goes without its suffix.

    ``hash`` is SHA-256 of the file's bytes: a file that changes is another instance.
    """

    name: str
    file: str
    path: Path
    hash: str

    @property
    def source(self) -> str:
        """Argument of ``read``, on another machine too: the name of a bundled instance, else the path."""
        bundled = self.file in bundled_names() and self.path == bundled_path(self.file)
        return self.file if bundled else str(self.path.resolve())


def named_instances(said: str, folder: Path, campaign: Path) -> list[Named]:
    """The instances that one entry of a campaign stands for; ``campaign`` is its file, for messages.

    An entry is a file, a bundled instance, or a pattern such as ``"solomon/C1*.txt"``, of names of bundled instances where no file matches;
    paths are relative to ``folder``. Raises InputError where nothing of that name is there, or it cannot be read.
    """
    path = folder / said
    try:
        if path.is_file():
            return [_named(said, path, campaign)]
        if path.is_dir():
            raise InputError(f"instance {said!r} is a folder; write {said.rstrip('/')}/* for the files in it", "file", file=campaign)
        if said in bundled_names():
            return [_named(said, bundled_path(said), campaign, said)]
        if any(sign in said for sign in _PATTERN):
            names = _matching(said, folder)
            named = [] if names else fnmatch.filter(bundled_names(), said)
            if named:
                return [_named(name, bundled_path(name), campaign, name) for name in named]
            if not names:
                raise InputError(f"no instance matches {said!r} (looked in {folder})", "missing", file=campaign)
            return [_named(str(file.relative_to(folder)) if file.is_relative_to(folder) else str(file), file, campaign) for file in names]
    except (OSError, ValueError) as fault:
        raise InputError(f"instance {said!r} cannot be looked for: {fault}", "file", file=campaign) from fault
    hint = did_you_mean(said, bundled_names())
    raise InputError(f"there is no instance {said!r}: no such file, and no bundled instance of that name{hint}", "missing", file=campaign)


def with_variables(said: str, campaign: Path) -> str:
    """A path in which ``$NAME`` stands for an environment variable.

    Raises InputError where there is no variable of that name.
    """
    for name in re.findall(r"\$(\w+)", said):
        if name not in os.environ:
            raise InputError(f"{said!r} needs the environment variable {name}, which is not set", "missing", file=campaign)
    return re.sub(r"\$(\w+)", lambda found: os.environ[found[1]], said)


def generated_instances(recipe: str, seeds: list[int], settings: dict[str, Any], folder: Path, campaign: Path) -> list[Named]:
    """Instances of a recipe, one a seed: files in ``folder``, made where they are not there.

    Raises UsageError for a recipe or a setting that does not exist; InputError for a file that cannot be written.
    """
    words = re.sub(r"[^\w=.]+", "-", " ".join(f"{key}={value}" for key, value in settings.items()))
    place = folder / f"{words[:100]}-{short_hash(canonical(settings))[:6]}".lstrip("-")
    named = []
    for seed in seeds:
        path = place / f"{recipe}-{seed}.json"
        if not path.is_file():
            try:
                instance = generate(recipe, seed, **settings)
            except UsageError as fault:
                raise UsageError(f"{campaign}: {fault}", fault.code) from None
            with suppress(OSError):  # told where the file is written
                place.mkdir(parents=True, exist_ok=True)
            write_instance(instance, path)
        named.append(_named(f"{folder.name}/{place.name}/{path.name}", path, campaign))
    return named


def files_named(changes: dict[str, Any], folder: Path) -> dict[str, str]:
    """Hashes of the files that changes of the data name, such as ``fleet = "fleet.csv"``."""
    texts = {key: folder / value for key, value in changes.items() if isinstance(value, str)}
    return {key: hash_of(path) for key, path in texts.items() if path.is_file()}


def hash_of(path: Path) -> str:
    """SHA-256 of a file's bytes."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _named(said: str, path: Path, campaign: Path, name: str | None = None) -> Named:
    try:
        return Named(name or path.stem, said, path, hash_of(path))
    except OSError as fault:
        raise InputError(f"instance {said!r} cannot be read: {fault.strerror}", "file", file=campaign) from fault


def _matching(said: str, folder: Path) -> list[Path]:
    absolute = Path(said)
    if absolute.is_absolute():
        return sorted(path for path in Path(absolute.anchor).glob(str(absolute.relative_to(absolute.anchor))) if path.is_file())
    return sorted(path for path in folder.glob(said) if path.is_file())
