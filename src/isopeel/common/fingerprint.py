"""A fingerprint of the code that numbers depend on."""

import ast
import hashlib
from functools import cache
from pathlib import Path

import isopeel
from isopeel.common.layers import left_of


@cache
def code_fingerprint(*layers: str) -> str:
    """Return the hash of layers and of those left of them, without their comments, docstrings and layout.

    It differs between versions of Python, as their syntax trees differ.
    """
    root = Path(isopeel.__file__).parent
    digest = hashlib.sha256()
    for source in sorted(set(layers).union(*map(left_of, layers))):
        for path in sorted((root / source).rglob("*.py")):
            digest.update(path.relative_to(root).as_posix().encode())
            digest.update(_meaning(path.read_text("utf-8")).encode())
    return digest.hexdigest()


def _meaning(source: str) -> str:
    tree = ast.parse(source)
    for node in ast.walk(tree):
        documented = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
        if isinstance(node, documented) and ast.get_docstring(node) is not None:
            del node.body[0]
    return ast.dump(tree)
