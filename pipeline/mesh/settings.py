"""What a user may ask of the mesh: keys that every engine reads, and a table for each engine's own."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import TYPE_CHECKING, Any, Literal, Self, TypeVar

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    SerializerFunctionWrapHandler,
    create_model,
    model_serializer,
    model_validator,
)

from pipeline.mesh.engines.engine import Engine, EngineSettings
from pipeline.mesh.engines.registry import DEFAULT, ENGINES
from pipeline.units import Fraction, Memory, PositiveRatio, Ratio

_Own = TypeVar("_Own", bound=EngineSettings)


class SharedSettings(BaseModel):
    """Settings of the stage `tetmesh`; lengths are in mean fiber diameters, so that a case scales as a whole."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    engine: str = Field(
        default=DEFAULT, description="The mesher: " + "; ".join(f'"{e.name}": {e.meaning}' for e in ENGINES.values())
    )
    edge: PositiveRatio = Field(
        default=0.6, le=20, description="Edge length of the tetrahedra at a fiber, in diameters of that fiber."
    )
    growth: Ratio = Field(
        default=1.0,
        le=3,
        description="How much longer the edges become per distance from the fibers; 0 for the same length everywhere.",
    )
    largest_edge: PositiveRatio = Field(
        default=3.0, description="Longest edge length far from the fibers, in mean fiber diameters."
    )
    volume_error: Fraction = Field(
        default=0.02, description="Largest error of the fibers' volume against the surface that is accepted."
    )
    deviation: PositiveRatio = Field(
        default=0.5,
        description="Distance from the true fibers within which 99 % of the walls' area has to lie, in mean fiber "
        "diameters.",
    )
    memory_limit: Memory | None = Field(
        default=None,
        description="A mesh that would take more memory is refused, the mesher ended above it; if left out, 85 % of "
        "what is free.",
    )

    @property
    def mesher(self) -> Engine:
        """The engine that the case names."""
        return ENGINES[self.engine]

    def own(self, kind: type[_Own]) -> _Own:
        """Give the chosen engine's own table, which is of that kind.

        Raises
        ------
        TypeError
            If the case names another engine.
        """
        table = getattr(self, self.engine)
        if not isinstance(table, kind):
            raise TypeError(f"the engine {self.engine} has {type(table).__name__}, not {kind.__name__}")
        return table

    def changed(self, **keys: object) -> Self:
        """Give a copy with other values of shared keys and of the chosen engine's own.

        With another `engine` the copy has that engine's table, at its defaults where `keys` do not say otherwise.
        """
        content = self.model_dump()
        old = content.pop(self.engine)
        engine = ENGINES[str(keys.get("engine", self.engine))]
        own = {key: value for key, value in keys.items() if key in engine.settings.model_fields}
        shared = {key: value for key, value in keys.items() if key not in own}
        table = {**(old if engine.name == self.engine else {}), **own}
        return type(self).model_validate({**content, **shared, engine.name: table})

    def scaled(self, factor: float) -> Self:
        """Give a copy whose every length is longer by a factor; growth too, so that as many cells lie in a gap."""
        lengths = {name: getattr(self, name) * factor for name in ("edge", "growth", "largest_edge")}
        envelope = getattr(getattr(self, self.engine), "envelope", None)
        return self.changed(**lengths, **({} if envelope is None else {"envelope": envelope * factor}))

    @model_validator(mode="before")
    @classmethod
    def _chosen_table_is_there(cls, content: Any) -> Any:
        # a default that changes must change what the results depend on: the chosen table is always written out
        if not isinstance(content, dict):
            return content
        engine = content.get("engine", DEFAULT)
        known = isinstance(engine, str) and engine in ENGINES
        return {**content, engine: {}} if known and content.get(engine) is None else content

    @model_validator(mode="after")
    def _nothing_is_silently_ignored(self) -> Self:
        for name in ENGINES:
            if name != self.engine and getattr(self, name) is not None:
                raise ValueError(
                    f'the table [tetmesh.{name}] means nothing to tetmesh.engine = "{self.engine}"; leave it out'
                )
        return self

    @model_serializer(mode="wrap")
    def _chosen_table_alone(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return {key: value for key, value in handler(self).items() if key == self.engine or key not in ENGINES}


if TYPE_CHECKING:
    TetmeshSettings = SharedSettings
else:
    # pydantic makes each engine's table a key of its own: an engine adds none here
    TetmeshSettings = create_model(
        "TetmeshSettings",
        __base__=SharedSettings,
        __doc__=SharedSettings.__doc__,
        engine=(Literal[tuple(ENGINES)], SharedSettings.model_fields["engine"]),
        **{
            name: (engine.settings | None, Field(default=None, description=engine.settings.__doc__))
            for name, engine in ENGINES.items()
        },
    )
