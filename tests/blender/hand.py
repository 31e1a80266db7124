# SPDX-License-Identifier: GPL-3.0-or-later
"""Simulated mouse in a real window: finds buttons of the sidebar, clicks, drags, counts clicks."""

import subprocess
import tempfile
import time
from collections.abc import Callable, Generator
from pathlib import Path
from typing import Any

import bpy

Story = Generator[Any, None, Any]
_ROW = 12  # pixels between two positions that are tried
_COLUMNS = (0.62, 0.75, 0.84, 0.3, 0.46)  # shares of the sidebar's width, including its tabs
_PATIENCE = 60.0  # seconds


class Hand:
    """Mouse actions in the 3D View, its sidebar and its toolbar."""

    def __init__(self, over: Callable[[], bpy.types.Region] | None = None) -> None:
        self.over = over or sidebar  # the region with the buttons
        self.columns = _COLUMNS  # columns that are tried
        self.clicks = 0  # and pressed keys
        self.searched = 0.0  # seconds spent on finding buttons
        self.seen: list[str] = []  # texts found by the last search

    def move(self, x: float, y: float) -> Story:
        window().event_simulate("MOUSEMOVE", "NOTHING", x=int(x), y=int(y))
        yield

    def click(self, x: float, y: float, button: str = "LEFTMOUSE", ctrl: bool = False) -> Story:
        yield from self.move(x, y)
        yield
        for value in ("PRESS", "RELEASE"):
            window().event_simulate(button, value, x=int(x), y=int(y), ctrl=ctrl)
            yield
        self.clicks += 1

    def drag(
        self,
        places: list[tuple[float, float]],
        before_release: Callable[[], Story] = tuple,
        ctrl: bool = False,
    ) -> Story:
        """Drag along these places with the button held; counts as one click."""
        yield from self.move(*places[0])
        yield from self.move(*places[0])  # later events go to the region under the pointer
        self._mouse("PRESS", places[0], ctrl)
        yield
        for place in places:
            yield from self.move(*place)
        yield from before_release()
        self._mouse("RELEASE", places[-1])
        yield
        self.clicks += 1

    def drag_asset(self, browser: bpy.types.Area) -> Story:
        """Drag the first asset of a browser near to the middle of the 3D View."""
        region, goal = part_of(browser, "WINDOW"), viewport()
        x, y = region.x + 60, region.y + region.height - 60
        right = goal.x + 0.4 * goal.width - x
        up = goal.y + 0.5 * goal.height - y
        yield from self.drag([(x + k / 40 * right, y + k / 40 * up) for k in range(41)])

    def _mouse(self, value: str, place: tuple[float, float], ctrl: bool = False) -> None:
        window().event_simulate("LEFTMOUSE", value, x=int(place[0]), y=int(place[1]), ctrl=ctrl)

    def press(self, key: str, x: float, y: float) -> Story:
        yield from self.move(x, y)
        for value in ("PRESS", "RELEASE"):
            window().event_simulate(key, value, x=int(x), y=int(y))
            yield
        self.clicks += 1

    def press_button(self, wanted: str) -> Story:
        """Click the button whose command or value contains a text."""
        place = yield from self.found(wanted)
        yield from self.click(*place)

    def slide(self, wanted: str) -> Story:
        """Drag a slider from its middle to its right end, and beyond."""
        x, y = yield from self.found(wanted)
        yield from self.drag([(x + 12 * k, y) for k in range(25)])

    def open_panel(self, wanted: str, below: str) -> Story:
        """Click the header of a closed panel below a button: the one that shows the wanted one."""
        if (yield from self._seen(wanted)) is not None:
            return
        begin, before = time.monotonic(), self.searched
        _, top = yield from self.found(below)
        for header in (yield from self._headers(top)):
            yield from self.click(*header)
            if (yield from self._seen(wanted)) is not None:
                self.searched = before + time.monotonic() - begin
                return
            yield from self.rest()
            yield from self.click(*header)
            yield from self.rest()
            self.clicks -= 2  # these clicks only searched
        raise LookupError(f"there is no panel with {wanted}")

    def rest(self) -> Story:
        """Wait so long that two clicks are not a double click."""
        end = time.monotonic() + 0.5
        while time.monotonic() < end:
            yield

    def found(self, wanted: str) -> Story:
        """The place of a button."""
        place = yield from self._seen(wanted)
        if place is None:
            seen = ", ".join(dict.fromkeys(self.seen))
            raise LookupError(f"there is no button with {wanted}, but {seen}")
        return place

    def _seen(self, wanted: str) -> Story:
        begin = time.monotonic()
        place = yield from self._looked_for(wanted)
        self.searched += time.monotonic() - begin
        return place

    def _looked_for(self, wanted: str) -> Story:
        region, self.seen = self.over(), []
        for column in self.columns:
            x = region.x + column * region.width
            for y in range(region.y + region.height - 20, region.y + 10, -_ROW):
                yield from self.move(x, y)
                if any(wanted in one for one in under_pointer(region)):
                    yield from self.move(x, y)  # the pointer may still be over the previous button
                    yield
                there = under_pointer(region)
                self.seen += there
                if any(wanted in one for one in there):
                    return x, y
        return None

    def _headers(self, top: float) -> Story:
        """Places where a panel may have its header: rows without a button."""
        region, free, found = sidebar(), 0, []
        x = region.x + 0.35 * region.width
        for y in range(int(top) - _ROW, region.y + 10, -_ROW):
            yield from self.move(x, y)
            if under_pointer(region):
                free = 0
                continue
            free += 1
            if free % 2 == 1:
                found.append((x, y))
        return found


def under_pointer(region: bpy.types.Region) -> list[str]:
    """The command of the button under the pointer, and the owner of its value."""
    area, found = view(), []
    manager = bpy.context.window_manager
    with bpy.context.temp_override(window=window(), area=area, region=region):
        copying: tuple[Any, ...] = (
            bpy.ops.ui.copy_python_command_button,
            bpy.ops.ui.copy_data_path_button,
        )
        for copy in copying:
            if copy.poll():
                manager.clipboard = ""
                copy()
                found.append(manager.clipboard)
    return found


def window() -> bpy.types.Window:
    return bpy.context.window_manager.windows[0]


def view() -> bpy.types.Area:
    return next(one for one in window().screen.areas if one.type == "VIEW_3D")


def part_of(area: bpy.types.Area, kind: str) -> bpy.types.Region:
    return next(one for one in area.regions if one.type == kind)


def sidebar() -> bpy.types.Region:
    return part_of(view(), "UI")


def toolbar() -> bpy.types.Region:
    return part_of(view(), "TOOLS")


def viewport() -> bpy.types.Region:
    return part_of(view(), "WINDOW")


def asset_library() -> Story:
    """The current scatter, marked as an asset, is the library; a new file is open then."""
    assert bpy.ops.dapple.mark_asset() == {"FINISHED"}
    for _ in range(200):  # Blender takes the picture meanwhile and must not lose the file
        yield
    yield from waited(lambda: not bpy.app.is_job_running("RENDER_PREVIEW"))
    folder = Path(tempfile.mkdtemp())
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "library.blend"), copy=True)
    bpy.ops.preferences.asset_library_add(directory=str(folder))
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
    yield
    yield


def asset_browser() -> Story:
    """Replace the properties editor by an asset browser; the timeline would be too low."""
    area = next(one for one in window().screen.areas if one.type == "PROPERTIES")
    area.ui_type = "ASSETS"
    for _ in range(100):
        yield
    area.spaces.active.params.asset_library_reference = "ALL"
    yield from waited(lambda: bool(_assets_of(area)))
    for _ in range(100):
        yield
    return area


def _assets_of(browser: bpy.types.Area) -> list[Any]:
    region = part_of(browser, "WINDOW")
    with bpy.context.temp_override(window=window(), area=browser, region=region):
        bpy.ops.file.select_all(action="SELECT")
        found = list(bpy.context.selected_assets or ())
        bpy.ops.file.select_all(action="DESELECT")
    return found


def waited(done: Callable[[], bool]) -> Story:
    """Wait until a condition holds."""
    end = time.monotonic() + _PATIENCE
    while not done():
        if time.monotonic() > end:
            raise TimeoutError("it is still not so")
        yield


def tab_is_shown() -> bool:
    """Open the sidebar with the add-on's tab, which it has once it was drawn."""
    view().spaces.active.show_region_ui = True
    view().tag_redraw()
    try:
        shown = sidebar().active_panel_category == "Dapple"
        sidebar().active_panel_category = "Dapple"
    except (AttributeError, TypeError):
        return False
    return shown


def shot(path: Path) -> Story:
    """A picture of the window. Blender's own of a virtual display are black."""
    for _ in range(20):
        view().tag_redraw()
        yield
    subprocess.run(["import", "-window", "root", str(path)], check=True)
