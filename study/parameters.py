"""Parameters that are described once: meaning, unit, range, default, and how a text is read.

A field of a dataclass, or a parameter of a function, has a `Parameter`. From it come the check of a
value, the options of the command line (`study.cli.options`) and the columns of a parameter study
(`study.sweep.cases`).
"""

from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass, field, fields, is_dataclass
from inspect import signature
from typing import Any, TypeVar

from study import checks

T = TypeVar("T")


@dataclass(frozen=True)
class Parameter:
    """Description of one value.

    Attributes
    ----------
    meaning
        What it is, as a phrase.
    unit, limits, whole
        Of a number: its unit, its range as keywords of `study.checks.number`, and whether it is
        a whole number.
    choices
        Words that are allowed, for a word.
    parse, kind
        For a value that is neither: the function of the parameter's name and a text that returns
        an object, and the class of that object, which may have no text.
    several, count
        Sign that separates such values in a text, if the value is a tuple of them: a semicolon, if
        they are given one by one on the command line, or a comma; and how many there must be, if
        not any number.
    otherwise, source
        A sentence on the default, where it depends on other parameters; and the source of the
        default.
    """

    meaning: str
    unit: str = ""
    limits: Mapping[str, float] = field(default_factory=dict)
    whole: bool = False
    choices: tuple[str, ...] = ()
    parse: Callable[[str, str], Any] | None = None
    kind: type = object
    several: str = ""
    count: int = 0
    otherwise: str = ""
    source: str = ""

    @property
    def typed(self) -> type:
        """Type of a single value on the command line: a number, or text."""
        if self.choices or self.kind is not object:
            return str
        return int if self.whole else float

    @property
    def range(self) -> str:
        """Range of the allowed values, or the allowed words; empty if there is no limit."""
        if self.choices:
            return ", ".join(self.choices)
        if self.limits.keys() == {"least", "most"}:
            return f"{self.limits['least']:g} to {self.limits['most']:g}"
        signs = {"above": ">", "least": ">=", "below": "<", "most": "<="}
        return " and ".join(f"{signs[name]} {limit:g}" for name, limit in self.limits.items())

    def read(self, name: str, text: str) -> Any:
        """Value of a text, in the form that the class or function of the parameter accepts.

        Raises ``ValueError`` if a number cannot be read. Objects and words are checked later, by
        the class or function itself.
        """
        if self.several:
            return tuple(self._read(name, part.strip()) for part in self._parts(name, text))
        return self._read(name, text)

    def _parts(self, name, text):
        parts = text.split(self.several)
        if self.count and len(parts) != self.count:
            wanted = f"{name} must be {self.count} values separated by {self.several!r}"
            raise ValueError(f"{wanted}, got {text!r}")
        return parts

    def _read(self, name, text):
        return text if self.typed is str else checks.read(name, text, self.typed, self.unit)

    def taken(self, name: str, value: Any) -> Any:
        """Value as a checked object or number; raises ``ValueError`` with what is allowed."""
        if not self.several:
            return self._taken(name, value)
        values = self.read(name, value) if isinstance(value, str) else value
        if not isinstance(values, tuple | list) or (self.count and len(values) != self.count):
            wanted = f"a tuple of {self.count} values" if self.count else "a tuple"
            raise ValueError(f"{name} must be {wanted}, got {checks.shown(value)}")
        return tuple(self._taken(name, one) for one in values)

    def written(self, value: Any) -> str:
        """Text of a value, from which it can be read again: numbers have 9 digits."""
        if isinstance(value, tuple):
            return self.several.join(map(self.written, value))
        return f"{value:.9g}" if isinstance(value, float) else str(value)

    def _taken(self, name, value):
        if self.choices:
            return checks.choice(name, value, self.choices)
        if self.kind is not object:
            if self.parse is not None and isinstance(value, str | int | float):
                value = self.parse(name, str(value))
            return checks.instance(name, value, self.kind)
        if self.whole:
            return checks.whole(name, value, **self.limits)
        if self.unit == "Pa" and not self.limits:
            return checks.youngs_modulus(name, value)
        return checks.number(name, value, self.unit, **self.limits, scalar=True)


def parameter(
    default: Any, meaning: str, unit: str = "", *, compare: bool = True, **described: Any
) -> Any:
    """Field of a dataclass with its `Parameter`; limits of a number are keywords.

    Without a default (``...``) the value must be given.
    """
    limits = {name: described.pop(name) for name in _LIMITS if name in described}
    given = {} if default is ... else {"default": default}
    about = Parameter(meaning, unit, limits, **described)
    return field(**given, compare=compare, metadata={"parameter": about})


_LIMITS = ("above", "least", "below", "most")


def describe(**parameters: Parameter) -> Callable[[T], T]:
    """Decorate a function with the descriptions of its parameters."""

    def decorate(function: T) -> T:
        vars(function)["described"] = parameters
        return function

    return decorate


def described(owner: Any) -> dict[str, Parameter]:
    """Parameters of a dataclass, or of a function that `describe` decorates, by name."""
    if not is_dataclass(owner):
        return owner.described
    ordered = sorted(fields(owner), key=lambda of: bool(of.kw_only))  # a class's own come first
    every = {of.name: of.metadata.get("parameter") for of in ordered}
    return {name: about for name, about in every.items() if about is not None}


def defaults(owner: Any) -> dict[str, Any]:
    """Default of each parameter that has one, by name."""
    if is_dataclass(owner):
        return {of.name: of.default for of in fields(owner) if of.default is not MISSING}
    every = signature(owner).parameters.values()
    return {p.name: p.default for p in every if p.default is not p.empty}


def take(record: Any, by_meaning: bool = False) -> None:
    """Check every described field of a frozen dataclass, and make objects of texts.

    None means a default that depends on other parameters. Errors name the field, or say what it
    means if a user does not type its name.
    """
    given = defaults(type(record))
    for name, about in described(type(record)).items():
        value = getattr(record, name)
        if value is not None or given.get(name, ...) is not None:
            label = about.meaning if by_meaning else name
            object.__setattr__(record, name, about.taken(label, value))


def default_of(owner: Any, name: str) -> str:
    """Default of a parameter for a reader; empty if it must be given or may be left out."""
    default = defaults(owner).get(name)
    about = described(owner)[name]
    return about.otherwise or ("" if default in (None, ()) else about.written(default))


READ = {"um": 1e-6, "mm^2": 1e-6, "MPa": 1e6, "N/um": 1e6, "%": 0.01}
"""Units in which a person reads a quantity that is stored in another unit, in that unit."""


@dataclass(frozen=True)
class Quantity:
    """A result: its meaning, its unit, and the unit in which a person reads it."""

    meaning: str
    unit: str = ""
    read: str = ""

    @property
    def scale(self) -> float:
        """The unit in which it is read, in the unit in which it is stored."""
        return READ.get(self.read, 1.0)


def stored(meaning: str, unit: str = "", read: str = "", **default: Any) -> Any:
    """Field of a dataclass with its `Quantity`; without a default it must be given."""
    return field(metadata={"quantity": Quantity(meaning, unit, read or unit)}, **default)


def derived(meaning: str, unit: str = "", read: str = "") -> Callable[[Callable], property]:
    """Decorate a method as a property with its `Quantity`."""

    def decorate(method: Any) -> property:
        method.quantity = Quantity(meaning, unit, read or unit)
        return property(method, doc=f"{meaning}{f', in {unit}' if unit else ''}.")

    return decorate


def quantities(owner: type) -> dict[str, Quantity]:
    """Quantities of a class by name: those of its fields, then those of its properties."""
    found = {of.name: of.metadata["quantity"] for of in fields(owner) if "quantity" in of.metadata}
    for name, of in vars(owner).items():
        if (about := getattr(getattr(of, "fget", None), "quantity", None)) is not None:
            found[name] = about
    return found
