"""What may be said to a page. A visitor without a browser says all that must not be said."""

import copy
import json
import time
from dataclasses import replace
from urllib.parse import quote

import msgspec
import pytest
import viser
import viser._viser
from viser import _messages

from app.page.controls import Controls
from app.page.visit.engine_links import FASTEST, MOST_WATCHED, PageEngineLinks, scene_size_refusal
from app.page.visit.first_scene import first_scene
from app.page.visit.run_session import RunSession
from app.problems.views import VIEWS
from app.viewer import incoming_messages, web_server, widget_validation
from solvers.problems import PROBLEMS
from tests.support.page_server import SilentPool
from tests.support.processes import wait_until
from tests.support.raw_client import CAMERA, RawClient, unknown_widget_id

#: What no widget of any kind can be; texts and truths are tried where they do not belong.
FIRST_SCENE = first_scene("bar")
NEVER = (None, [], {}, [1, 2], b"bytes", float("nan"), float("inf"), -float("inf"), {"a": [None]}, "x" * 20_001, 2**63)
NOT_A_NUMBER = ("5", "", True, False)
PROPERTIES = ("min", "max", "step", "precision", "options", "label", "hint", "disabled", "visible", "order", "_impl",
              "gui_api", "props", "uuid", "update_cb", "sync_cb", "removed", "is_button", "update_timestamp",
              "parent_container_id", "__class__", "__dict__", "no such")


@pytest.fixture
def visitor(here):
    with RawClient(here[1]) as one:
        one.find("Download CSV")  # the last of its controls
        yield one


def page_of(one):
    """The widgets of the only visitor, as the server has them, once there is one."""
    wait_until(lambda: len(one._connected_clients) == 1, "one visitor")
    return next(iter(one._connected_clients.values())).gui._gui_input_handle_from_uuid


def state(handle):
    """All that a widget is, now."""
    impl = handle._impl
    return [{name: copy.copy(value) if isinstance(value, list | dict) else value for name, value in vars(part).items()}
            for part in (impl, impl.props)]


def settle(one, visitor):
    """Return when the server has done all that one of its visitors said: it does one thing after the other."""
    widget, text = visitor.find("Tolerance"), str(time.perf_counter())
    visitor.set(widget, text)
    pages = [client.gui._gui_input_handle_from_uuid for client in list(one._connected_clients.values())]
    wait_until(lambda: any(widget in page and page[widget].value == text for page in pages), "the server has heard")


def bad_values(widget):
    """Values of a widget, as the page has described it, that no browser can have sent."""
    kind, props, value = widget["type"], widget["props"], widget.get("value")
    if kind in ("GuiSliderMessage", "GuiNumberMessage"):
        ends = [end for end in ((props["min"], -1), (props["max"], 1)) if end[0] is not None]
        beyond = [end + side * far for end, side in ends for far in (10.0 ** -props["precision"], 1, 1e5, 1e300)]
        return *NEVER, *NOT_A_NUMBER, *beyond, *([props["min"] + 0.5] if props["precision"] == 0 else [])
    if kind in ("GuiCheckboxMessage", "GuiButtonMessage"):
        return *NEVER, 0, 1, 2.0, "true", ""
    if kind in ("GuiDropdownMessage", "GuiButtonGroupMessage"):
        return *NEVER, 0, True, "no such", "", [props["options"][0]], props["options"][0] + " "
    if kind == "GuiTextMessage":
        return *NEVER, 0, True, 1.5, ["a"]
    return *NEVER, *NOT_A_NUMBER, value, 0, 50.0, "x"  # of a kind that takes no values


def good_values(widget):
    """Values that a browser sends."""
    kind, props = widget["type"], widget["props"]
    if kind in ("GuiSliderMessage", "GuiNumberMessage"):
        return props["min"], props["max"]
    if kind == "GuiCheckboxMessage":
        return not widget["value"], widget["value"]
    return {"GuiDropdownMessage": (*props.get("options", ())[::-1],), "GuiTextMessage": ("1", "")}.get(kind, ())


def test_a_page_begins_with_what_came_with_the_request_for_it(here):
    """Not with the opening, to become another one later."""
    asked = quote(json.dumps({"link": "bar;cells=24"}))
    with RawClient(f"{here[1]}/?lang=en&first={asked}") as visitor:
        assert visitor.widgets[visitor.find("Cells, typed")]["value"] == "24"


@pytest.fixture(params=["vibrating bar", "expanding ring"])
def complete(here, visitor, request):
    """The visitor, once all of a problem's controls are there."""
    visitor.set(visitor.find("Problem"), request.param)
    visitor.find(f"grid cells across {1.2 if request.param == 'expanding ring' else 1} m")
    visitor.find("step margin")
    settle(here[0], visitor)
    return visitor


def test_no_control_takes_what_a_browser_cannot_send(here, complete):
    """Every control that the page has, whatever it is: values out of range and of other types, all other properties,
    alone and beside a good value, and the widget's own insides. Nothing of it changes anything."""
    one, visitor, tried = here[0], complete, 0
    handles = page_of(one)
    assert handles.keys() == visitor.widgets.keys() and len(handles) > 40
    for name, widget in visitor.widgets.items():
        before = state(handles[name])
        for value in (bad := bad_values(widget)):
            visitor.set(name, value)
        for other in PROPERTIES:
            visitor.send({"type": "GuiUpdateMessage", "uuid": name, "updates": {other: widget.get("value")}})
            visitor.set(name, widget.get("value"), **{other: 3})
        tried += len(bad) + 2 * len(PROPERTIES)
        settle(one, visitor)
        if visitor.label(name) != "Tolerance":  # by which it is heard that all was said
            assert state(handles[name]) == before, visitor.label(name)
    assert tried > 2000 and visitor.closed is None


def test_every_control_takes_what_a_browser_sends(here, complete):
    one, visitor, taken = here[0], complete, set()
    for name, widget in list(visitor.widgets.items()):
        label, off = visitor.label(name), widget["props"].get("disabled") or not widget["props"]["visible"]
        if label in ("Problem", "Lesson", "Motion") or off:  # by which others go
            continue
        assert type(page_of(one)[name]) in widget_validation.RULES or widget["type"] in ("GuiProgressBarMessage",
                                                                               "GuiUploadButtonMessage")
        for value in good_values(widget):
            before, old = page_of(one)[name].update_timestamp, page_of(one)[name].value
            visitor.set(name, value)
            if value != old:
                # Estimators that were switched off a moment ago go from among the options.
                wait_until(lambda n=name, t=before, v=value: page_of(one)[n].update_timestamp > t
                           or v not in getattr(page_of(one)[n], "options", (v,)), f"{label}: {value}")
                taken.add(label)
    assert len(taken) > 30


def test_a_text_may_be_long_only_where_it_says_so(here, visitor):
    one, _ = here
    for label, longest in (("Trace particle", 200), ("kept by the browser", 20_000)):
        text = page_of(one)[visitor.find(label)]
        assert widget_validation.why_value_refused(text, "x" * longest) is None
        assert "cannot have" in widget_validation.why_value_refused(text, "x" * (longest + 1))


def test_what_is_off_takes_nothing(here, visitor):
    """A browser shows it grey, or not at all."""
    one, _ = here
    back, hidden = visitor.find("Look back"), visitor.find("Stop tracing")
    clicked = page_of(one)[hidden].update_timestamp
    visitor.set(back, -1)
    visitor.set(hidden, True)
    settle(one, visitor)
    assert page_of(one)[back].value == 0 and page_of(one)[hidden].update_timestamp == clicked


def test_messages_that_no_page_sends_are_refused(here, visitor):
    """Kinds that it has no use for, fields that are missing, too many or mad, ids that nothing has, and noise."""
    one, _ = here
    assert page_of(one)
    client = next(iter(one._connected_clients.values()))
    heard = []
    client.camera.on_update(lambda camera: heard.append(camera.image_width))
    click = {"type": "ScenePointerMessage", "event_type": "click", "ray_origin": [0.0, 0.0, 9.0],
             "ray_direction": [0.0, 0.0, -1.0], "screen_pos": [[0.5, 0.5]], "modifier": None}
    update = {"type": "GuiUpdateMessage", "uuid": visitor.find("Longest run, s"), "updates": {"value": "7"}}
    mad = [CAMERA | {field: value} for field, value in [
        ("position", [float("nan")] * 3), ("position", [1e9, 0, 0]), ("position", [0, 0]), ("wxyz", [0, 0, 0, 0]),
        ("wxyz", ["1", 0, 0, 0]), ("fov", 0), ("fov", 1e9), ("image_width", 0), ("image_height", 10**9), ("near", -1),
        ("image_width", True), ("look_at", None), ("look_at", CAMERA["position"]),
        ("up_direction", "up"), ("excluded_self_client", 0)]]
    mad += [click | {field: value} for field, value in [
        ("ray_direction", [1.0, 0.0, 0.0]), ("ray_direction", None), ("ray_origin", None), ("screen_pos", []),
        ("screen_pos", [[float("inf"), 0]]), ("event_type", "drag"), ("event_type", []), ("modifier", 5)]]
    mad += [update | {"uuid": unknown_widget_id()}, update | {"uuid": 5}, update | {"updates": {}},
            update | {"updates": [1]}, {"type": "GuiUpdateMessage"}, {"type": "NoSuchMessage"}, {"type": ["a"]},
            {"type": None}, {}, [], 5, None, {"updates": {"value": 1}}, update | {"excluded_self_client": 3}]
    mad += [{"type": kind.__name__} for kind in _messages.Message.get_subclasses()]
    noise = [b"", b"\x00", b"\xff" * 100, b"\x91" * 30_000, b"\xdf\xff\xff\xff\xff", "text", "", b"\x81\xc0\xc0",
             msgspec.msgpack.encode({"type": "ViewerCameraMessage"} | {str(k): k for k in range(2000)}),
             b"\x90" * 999_000]
    for message in mad + noise:
        visitor.send(message)
    settle(one, visitor)
    assert visitor.closed is None and heard == []
    visitor.send(CAMERA | {"image_width": 601})
    visitor.send(update)
    wait_until(lambda: heard == [601] and page_of(one)[update["uuid"]].value == "7", "the good ones")


def test_kinds_of_messages_are_those_of_the_viewer():
    """If this fails, the viewer's messages have changed: put ``FIELDS`` in ``app/viewer/incoming_messages.py``
    right."""
    for kind, fields in incoming_messages.FIELDS.items():
        known = set(getattr(_messages, kind).__dataclass_fields__)
        assert known == set(fields), f"{kind} has the fields {known}"


def test_every_message_goes_through_the_check(here, visitor, monkeypatch):
    """If this fails, the viewer reads its websocket or knows its visitors otherwise than it did in 1.1.1: see
    ``IncomingMessageFilter`` in ``app/viewer/incoming_messages.py`` and ``AccessControl._find_widget`` in
    ``app/viewer/web_server.py``."""
    one, _ = here
    heard = []
    check = incoming_messages.why_message_refused
    monkeypatch.setattr(incoming_messages, "why_message_refused", lambda message,
                        *how: heard.append(message) or check(message, *how))
    widget = visitor.find("Longest run, s")
    visitor.set(widget, "8")
    wait_until(lambda: page_of(one)[widget].value == "8", "a value is set")
    assert len(heard) == 1
    assert list(one._websock_server._live_connections) == list(one._connected_clients)


def test_no_way_leads_to_a_tunnel(here, visitor, monkeypatch):
    """Neither a message nor the server's own method makes the viewer's tunnel."""
    one, _ = here
    made = []
    monkeypatch.setattr(viser._viser, "ViserTunnel", lambda *_: made.append(1))
    for kind in ("ShareUrlRequest", "ShareUrlDisconnect"):
        visitor.send({"type": kind})
        for handler in one._websock_server._incoming_handlers[getattr(_messages, kind)]:
            handler(0, None)  # as the viewer would, if the message had come through
    settle(one, visitor)
    assert one.request_share_url() is None and one.disconnect_share_url() is None
    assert made == [] and one._share_tunnel is None


def test_problem_that_is_chosen_while_the_page_is_made(here, monkeypatch):
    """As fast as its control is there: it is met when the others are."""
    build, chosen = Controls._build, []

    def slowly(controls):
        if not chosen:
            chosen.append(1)
            visitor.set(visitor.find("Problem"), "expanding ring")
            wait_until(lambda: controls.problem.value == "expanding ring", "the choice to come")
        build(controls)

    monkeypatch.setattr(Controls, "_build", slowly)
    with RawClient(here[1], arrive=False) as visitor:
        visitor.send(CAMERA)
        visitor.find("grid cells across 1.2 m")


def test_socket_that_never_speaks_is_closed(monkeypatch, here):
    """Also one that says only what is refused; who says where the camera is may then be as silent as it likes."""
    monkeypatch.setattr(web_server, "SILENT", 0.5)
    with RawClient(here[1], arrive=False) as mute, RawClient(here[1],
                                                             arrive=False) as babbler, RawClient(here[1]) as visitor:
        babbler.send(b"nothing that means anything")
        wait_until(lambda: mute.closed and babbler.closed, "both closed")
        assert (mute.closed, babbler.closed, visitor.closed) == (1008, 1008, None)
        assert mute.socket.close_reason == web_server.NOTHING_SAID


def test_what_is_refused_is_wished_no_longer():
    """It is said of which field, until anything else is asked for, which is done with the value that there was. No more
    than one visitor may have is asked for, whatever the widgets let through: particles, and with them memory; and
    periods a second."""
    session = RunSession(PageEngineLinks(SilentPool()), FIRST_SCENE, lambda *_: None)
    session.set_scene_fields(amplitude=0.2)
    field, sentence = session.refused
    assert field == "amplitude" and "0.159" in sentence and session.scene == FIRST_SCENE
    session.set_scene_fields(cells=20)
    fits, many, fast = replace(FIRST_SCENE, cells=20), "particles are too many", "periods a second are too many"
    assert session.refused is None and session.scene == fits
    for ask, field, said in ((lambda: session.set_scene_fields(cells=MOST_WATCHED), "cells", many),
                             (lambda: session.set_speed(1e300), "speed", fast),
                             (lambda: session.refuse("no number", "modulus"), "modulus", "no number"),
                             (lambda: session.set_scene(replace(fits, cells=MOST_WATCHED)), "", many)):
        ask()
        assert session.refused[0] == field and session.idle_seconds < 1
        notice = session.notice()
        assert notice.seen == bool(field) and said in notice.sentence.lower()  # under its control, else over the stage
        assert session.scene == fits and session.speed < FASTEST
        session.play(True)
        assert session.refused is None


@pytest.mark.parametrize("problem", PROBLEMS)
def test_sliders_reach_no_scene_that_is_refused(problem):
    reach = VIEWS[problem].slider_ranges
    assert not scene_size_refusal(PROBLEMS[problem].scene(cells=reach.cells[1], ppc=reach.ppc[1]))

