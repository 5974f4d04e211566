"""Kinds of instances in waybound's JSON: each module registers how its kind is written and read back."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from .declared import Declared
from .instance import Instance
from .registry import Registry


@dataclass(frozen=True)
class Kind:
    """A kind of instance.

    Parameters
    ----------
    name : str
        Value of the key ``kind``, and of the instance's attribute of that name.
    encode : callable
        From an instance to the keys beside ``waybound`` and ``kind``.
    decode : callable
        Its inverse. Raises InputError naming the key by its path; refuses unknown keys.
    """

    name: str
    encode: Callable[[Any], dict[str, Any]]
    decode: Callable[[dict[str, Any]], Instance]


KINDS: Registry[Kind] = Registry("kind", "waybound.instances.*.json_kind", group="waybound.kinds")


def kind_of(model: type[Declared]) -> Kind:
    """The kind of instances that declare how they stand in JSON."""
    return Kind(model.kind, model.to_document, model.from_document)
