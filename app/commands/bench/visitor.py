"""A visitor without a browser: speaks the page's websocket, counts the frames that come and moves the controls."""

import math
import random
from bisect import bisect_right
from dataclasses import dataclass, field
from itertools import pairwise
from time import monotonic
from typing import Any

from app.viewer.client import connected

FRAME = "/field/particles"  # the end of the name of what every frame of every problem sets
BROKEN = "class='lab-notice lab-unstable'"  # what the page puts around the reason why a run has stopped
CAMERA = {"type": "ViewerCameraMessage", "wxyz": (1.0, 0.0, 0.0, 0.0), "position": (0.5, 0.5, 20.0), "fov": 0.07,
          "near": 1.0, "far": 400.0, "image_height": 640, "image_width": 760, "look_at": (0.5, 0.5, 0.0),
          "up_direction": (0.0, 1.0, 0.0)}
ON_ITS_WAY = 0.25  # seconds after a choice in which a frame may come that was sent before it


def is_frame(message: dict) -> bool:
    """Whether it is a picture of particles: axes, too, are told where their points are, long before the first one."""
    return message.get("name", "").endswith(FRAME) and "points" in message.get("updates", {})


@dataclass
class Control:
    """A widget that the server has sent: what kind it is, its label and all that was said of it."""

    kind: str
    props: dict[str, Any]

    @property
    def label(self) -> str:
        return str(self.props.get("label", ""))


@dataclass
class Visitor:
    """One visitor of the page at ``address`` (host:port). Times are of ``time.monotonic``."""

    address: str
    asked: float = 0.0  # when it knocked
    frames: list[float] = field(default_factory=list)  # when they came
    choices: list[float] = field(default_factory=list)  # when it has set a control
    broken: set[int] = field(default_factory=set)  # before which of them it was said that the run has broken down
    notice: str = ""  # the number of the text that says so now
    controls: dict[str, Control] = field(default_factory=dict)  # by their number

    async def stay(self) -> None:
        """Until the connection is closed, from either side."""
        self.asked = monotonic()
        async with connected(self.address) as connection:
            self._connection = connection
            await connection.send(CAMERA)
            async for messages in connection:
                self._take(messages)

    async def move(self, control: str, value: Any) -> None:
        """Set the control with this number."""
        self.choices.append(monotonic())
        await self._connection.send({"type": "GuiUpdateMessage", "uuid": control, "updates": {"value": value}})

    def find(self, label: str, kind: str = "") -> str | None:
        """The number of the control whose label begins so, of a kind that has this in its name."""
        return next((number for number, control in self.controls.items()
                     if control.label.startswith(label) and kind in control.kind), None)

    async def play_with(self, label: str, dice: random.Random) -> None:
        """Set a slider to anything that it may be, if it is there."""
        if number := self.find(label, "Slider"):
            low, high, step = (self.controls[number].props[name] for name in ("min", "max", "step"))
            steps = max(1, round((high - low) / step))
            await self.move(number, round(low + step * dice.randint(0, steps), 9))

    def rate(self, begin: float, end: float) -> float | None:
        """Frames a second between two times, while there was something to see; None if there never was."""
        seconds = sum(until - since for since, until in self._pauses(begin, end))
        seen = sum(begin <= at < end for k, at in enumerate(self.frames) if k not in self.broken)
        return seen / seconds if seconds else None

    def standstill(self, begin: float, end: float, own: bool = False) -> float:
        """The longest time without a frame between two times, in s, of those that followed a choice of its ``own``, or
        of all others."""
        def chosen(since: float, until: float) -> bool:  # found at once: an hour has 100,000 frames and 1,000 choices
            following = bisect_right(self.choices, since - ON_ITS_WAY)
            return following < len(self.choices) and self.choices[following] < until

        return max((until - since for since, until in self._pauses(begin, end) if own == chosen(since, until)),
                   default=0.0)

    def _pauses(self, begin: float, end: float) -> list[tuple[float, float]]:
        """From when to when there was no frame between two times, but for where a run had broken down: it stands still
        until the visitor asks for something else."""
        times = [-math.inf, *self.frames, math.inf]
        broken = self.broken | ({len(self.frames)} if self.notice else set())
        return [(max(earlier, begin), min(later, end)) for k, (earlier, later) in enumerate(pairwise(times))
                if later > begin and earlier < end and k not in broken]

    def _take(self, messages: list[dict[str, Any]]) -> None:
        framed = False
        for message in messages:
            match message["type"]:
                case "SceneNodeUpdateMessage":
                    framed |= is_frame(message)
                case "GuiUpdateMessage" if message["uuid"] in self.controls:
                    self.controls[message["uuid"]].props.update(message["updates"])
                    self._read(message["uuid"], message["updates"].get("content"))
                case "GuiRemoveMessage":
                    self.controls.pop(message["uuid"], None)
                case kind if kind.startswith("Gui") and "props" in message:
                    self.controls[message["uuid"]] = Control(kind, {"value": message.get("value"), **message["props"]})
        if framed:
            if self.notice:
                self.broken.add(len(self.frames))
            self.frames.append(monotonic())

    def _read(self, text: str, content: Any) -> None:
        """A text says something else now."""
        if BROKEN in str(content):
            self.notice = text
            self.broken.add(len(self.frames))
        elif content is not None and text == self.notice:  # the page may say so before the first frame of another run
            self.broken.add(len(self.frames))
            self.notice = ""
