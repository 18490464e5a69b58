"""What the route of the shapes answers."""

from typing import Self

from pydantic import Field

from stepramp.design import FIELDS_OF_PARAMETERS, MethodName, ShapeName
from stepramp.http_api.answer import Answer
from stepramp.methods import METHODS
from stepramp.numerics.slope import Slope
from stepramp.shapes import SHAPES, USUAL_SHAPE


class ShapeAnswer(Answer):
    """A shape of ramps, and what people are told of it."""

    name: ShapeName
    label: str
    help: str = Field(description="What it is good for")
    fields: list[str] = Field(description="Those of ramp.shape that it has besides its name")
    methods: list[MethodName] = Field(description="Those that compute a ramp of this shape")
    begins_alike: bool = Field(
        description="Whether a ramp to a lower speed is the beginning of the one to a higher speed, so that move.plan "
        "makes no difference"
    )

    @classmethod
    def of(cls, name: ShapeName, shape: type[Slope]) -> Self:
        """Return what is told of a shape."""
        return cls(
            name=name,
            label=shape.label or name,
            help=shape.help,
            fields=[
                field for each in FIELDS_OF_PARAMETERS if each in shape.takes for field in FIELDS_OF_PARAMETERS[each]
            ],
            methods=[
                each for each, method in METHODS.items() if method.shape is None or issubclass(shape, method.shape)
            ],
            begins_alike=shape.begins_alike,
        )


class ShapesAnswer(Answer):
    """The shapes, in the order in which people are shown them."""

    usual: ShapeName = Field(description="That of a design that names none")
    shapes: list[ShapeAnswer]

    @classmethod
    def of_all(cls) -> Self:
        """Return what is told of the shapes that there are."""
        return cls(usual=USUAL_SHAPE, shapes=[ShapeAnswer.of(name, shape) for name, shape in SHAPES.items()])
