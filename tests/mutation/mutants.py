"""Small faults that could be in a module: one changed operator, number, condition or call each.

Texts are left as they are: what a message says is for people, and tests quote its figures.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import ast
import copy
from collections.abc import Iterator
from dataclasses import dataclass

_COMPARE = {
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
    ast.In: ast.NotIn, ast.NotIn: ast.In, ast.Is: ast.IsNot, ast.IsNot: ast.Is,
}  # fmt: skip
_ARITHMETIC = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.FloorDiv: ast.Div,
    ast.Mod: ast.Mult, ast.Pow: ast.Mult, ast.BitAnd: ast.BitOr, ast.BitOr: ast.BitAnd, ast.BitXor: ast.BitAnd,
}  # fmt: skip
_TWINS = {"min": "max", "minimum": "maximum", "any": "all", "floor": "ceil", "argmin": "argmax", "sin": "cos"}
_SWAPPED = {**_TWINS, **{other: name for name, other in _TWINS.items()}}


@dataclass(frozen=True, slots=True)
class Mutant:
    """One fault: its number within the module, its line, and what became of what."""

    number: int
    line: int
    told: str


def mutants(text: str) -> list[Mutant]:
    r"""Give every fault of a module's text, in the order of its lines.

    Examples
    --------
    >>> [fault.told for fault in mutants("def f(x): return x + 1")]
    ['x + 1 -> x - 1', '1 -> 2']
    """
    return [
        Mutant(number, getattr(node, "lineno", 0), f"{ast.unparse(node)} -> {ast.unparse(changed)}")
        for number, (node, changed) in enumerate(_faults(ast.parse(text)))
    ]


def mutated(text: str, mutant: Mutant) -> str:
    r"""Give a module's text with one fault in it.

    Examples
    --------
    >>> text = "def f(x): return x + 1"
    >>> print(mutated(text, mutants(text)[1]))
    def f(x):
        return x + 2
    """
    tree = ast.parse(text)
    node, changed = next(each for number, each in enumerate(_faults(tree)) if number == mutant.number)
    _replace(tree, node, changed)
    return ast.unparse(ast.fix_missing_locations(tree))


def _faults(tree: ast.AST) -> Iterator[tuple[ast.AST, ast.AST]]:
    for node in _code(tree):
        for changed in _changes(node):
            yield node, changed


def _code(node: ast.AST) -> Iterator[ast.AST]:
    """Walk through what runs: no annotation, no decorator, no docstring, no text, nothing for types alone."""
    yield node
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns", "decorator_list", "bases", "type_comment"):
            continue
        if isinstance(node, ast.If) and name == "body" and "TYPE_CHECKING" in ast.unparse(node.test):
            continue
        if isinstance(node, ast.JoinedStr | ast.Assert | ast.Import | ast.ImportFrom):
            continue
        # a message is told in words; the decision to raise it is not skipped
        if isinstance(node, ast.Raise):
            continue
        for inner in value if isinstance(value, list) else [value]:
            if isinstance(inner, ast.AST):
                yield from _code(inner)


def _changes(node: ast.AST) -> Iterator[ast.AST]:
    changed: ast.AST
    match node:
        case ast.Compare(ops=[operator]) if type(operator) in _COMPARE:
            changed = copy.deepcopy(node)
            changed.ops = [_COMPARE[type(operator)]()]
            yield changed
        case ast.BinOp(left=left, right=right, op=operator) if type(operator) in _ARITHMETIC:
            if isinstance(left, ast.Constant) and isinstance(left.value, str):
                return
            changed = copy.deepcopy(node)
            changed.op = _ARITHMETIC[type(operator)]()
            yield changed
            if isinstance(operator, ast.BitAnd | ast.BitOr):
                yield copy.deepcopy(left)
                yield copy.deepcopy(right)
        case ast.AugAssign(op=operator) if type(operator) in _ARITHMETIC:
            changed = copy.deepcopy(node)
            changed.op = _ARITHMETIC[type(operator)]()
            yield changed
        case ast.BoolOp(op=operator):
            changed = copy.deepcopy(node)
            changed.op = ast.Or() if isinstance(operator, ast.And) else ast.And()
            yield changed
        case ast.UnaryOp(op=ast.Not() | ast.USub() | ast.Invert(), operand=operand):
            yield copy.deepcopy(operand)
        case ast.Constant(value=bool() as value):
            yield ast.Constant(not value)
        case ast.Constant(value=int() as value):
            yield ast.Constant(value + 1)
        case ast.Constant(value=float() as value):
            yield ast.Constant(1.3 * value if value else 1.0)
        case ast.If(test=test) | ast.IfExp(test=test):
            if not isinstance(test, ast.Compare | ast.BoolOp | ast.UnaryOp):
                changed = copy.copy(node)
                changed.test = ast.UnaryOp(ast.Not(), test)
                yield copy.deepcopy(changed)
        case ast.Raise() | ast.Expr(value=ast.Call()):
            yield ast.Pass()
        case ast.Break():
            yield ast.Continue()
        case ast.Continue():
            yield ast.Break()
        case ast.Name(id=name) if name in _SWAPPED and isinstance(node.ctx, ast.Load):
            yield ast.Name(_SWAPPED[name], ast.Load())
        case ast.Attribute(attr=name) if name in _SWAPPED and isinstance(node.ctx, ast.Load):
            changed = copy.deepcopy(node)
            changed.attr = _SWAPPED[name]
            yield changed


def _replace(tree: ast.AST, target: ast.AST, changed: ast.AST) -> None:
    for parent in ast.walk(tree):
        for name, value in ast.iter_fields(parent):
            if value is target:
                setattr(parent, name, changed)
                return
            if isinstance(value, list):
                for place, inner in enumerate(value):
                    if inner is target:
                        value[place] = changed
                        return
