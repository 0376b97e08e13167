"""The one exception of the engine."""


class EngineError(Exception):
    """The engine refused its input, or was cancelled.

    code: the reason's name, one of those in ``partuv/error.hpp``.
    where: the element concerned, such as "face 12" or "option gutter_texels".
    """

    def __init__(self, code: str, where: str) -> None:
        super().__init__(f"{code}: {where}" if where else code)
        self.code = code
        self.where = where
