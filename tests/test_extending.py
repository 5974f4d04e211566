"""What a package outside waybound imports is one module, which names all that it gives."""

import ast
from pathlib import Path
from typing import Any

import waybound.extending as extending
from waybound.instances.registry import Registry


def test_every_public_name_is_one_for_type_checkers_too() -> None:
    """They take what is imported ``as`` itself or assigned; ``__all__``, which is computed, takes whatever has no underscore."""
    source = ast.parse(Path(extending.__file__).read_text(encoding="utf-8"))
    imports = [alias for node in source.body if isinstance(node, ast.Import | ast.ImportFrom) for alias in node.names]
    assigned = [ast.unparse(target) for node in source.body if isinstance(node, ast.Assign) for target in node.targets]
    told = [alias.name for alias in imports if alias.asname == alias.name] + [name for name in assigned if not name.startswith("_")]
    assert sorted(told) == extending.__all__


def registries() -> dict[str, Registry[Any]]:
    found = {name: getattr(extending, name) for name in extending.__all__}
    return {name: entry for name, entry in found.items() if isinstance(entry, Registry)}


def test_every_registry_is_on_the_page_with_its_group_of_entry_points() -> None:
    page = (Path(__file__).resolve().parents[1] / "docs" / "extending.md").read_text(encoding="utf-8")
    assert len(registries()) >= 9
    for registry in registries().values():
        assert f"`{registry.group}`" in page


def test_an_entry_of_each_registry_can_be_added_for_a_while_and_is_gone_afterwards() -> None:
    for registry in registries().values():
        with registry.temporary("added-by-a-test", object()):
            assert "added-by-a-test" in registry
        assert "added-by-a-test" not in registry
