"""The page of a run in a browser: it loads alone, follows pointer and keys, and reads well everywhere."""

import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from runs import failed, staged, strip, two_bodies
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.remote.webelement import WebElement

from isopeel.html_report.write import write_html_report
from isopeel.post.fields import sample_fields
from isopeel.running.run_reader import read_stages

BROWSER, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
pytestmark = [
    pytest.mark.skipif(
        BROWSER is None or DRIVER is None, reason="no browser: chromium and chromedriver are not installed"
    ),
    # a page draws its own pictures
    pytest.mark.usefixtures("without_figures"),
]
FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
DESKTOP, PHONE = (1280, 900), (360, 740)
SMALLEST_TEXT = 12  # CSS pixels
# Web Content Accessibility Guidelines 2.2, criteria 1.4.3 (text) and 1.4.11 (graphics)
TEXT_CONTRAST, GRAPHICS_CONTRAST = 4.5, 3.0


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[webdriver.Chrome]:
    options = webdriver.ChromeOptions()
    options.binary_location = str(BROWSER)
    for flag in (*FLAGS, f"--user-data-dir={tmp_path_factory.mktemp('profile')}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(options, Service(str(DRIVER)))
    yield driver
    driver.quit()


@pytest.fixture(scope="module")
def strip_page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_html_report(strip(tmp_path_factory.mktemp("strip")))


@pytest.fixture(scope="module")
def staged_page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_html_report(staged(tmp_path_factory.mktemp("staged")))


def show(
    browser: webdriver.Chrome,
    page: Path,
    size: tuple[int, int] = DESKTOP,
    scheme: str = "light",
    script: bool = True,
) -> None:
    """Load a page, and see that nothing else is loaded and nothing complains."""
    width, height = size
    metrics = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": size == PHONE}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
    media = {"features": [{"name": "prefers-color-scheme", "value": scheme}]}
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", media)
    browser.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": not script})
    for name in ("browser", "performance"):
        log(browser, name)
    browser.get(page.as_uri())
    assert log(browser, "browser") == []
    assert [url for url in requests(browser) if not url.startswith("data:")] == [page.as_uri()]


def log(browser: Any, name: str) -> list[dict[str, str]]:
    """What a log holds since the last time."""
    entries: list[dict[str, str]] = browser.get_log(name)
    return entries


def requests(browser: webdriver.Chrome) -> list[str]:
    """The requests since the last call."""
    messages = (json.loads(entry["message"])["message"] for entry in log(browser, "performance"))
    return [
        message["params"]["request"]["url"]
        for message in messages
        if message["method"] == "Network.requestWillBeSent"
    ]


def picture(browser: webdriver.Chrome, name: str, stage: int = 1) -> str:
    script = "return document.querySelector(arguments[0]).toDataURL()"
    return str(browser.execute_script(script, f"#stage-{stage} canvas.{name}"))


def pictures(browser: webdriver.Chrome, stage: int = 1) -> dict[str, str]:
    names = ("curve", "body", "front", "tractions", "iterations")
    return {name: picture(browser, name, stage) for name in names}


def slider(browser: webdriver.Chrome, stage: int = 1) -> WebElement:
    return browser.find_element(By.CSS_SELECTOR, f"#stage-{stage} input")


def point(browser: webdriver.Chrome, selector: str, kind: str, x: float, y: float) -> None:
    """Let a pointer do something at a place on an element, from its upper left corner."""
    script = """
    const [element, kind, x, y] = [document.querySelector(arguments[0]), ...[...arguments].slice(1)];
    element.scrollIntoView();
    const { left, top } = element.getBoundingClientRect();
    const buttons = kind === "pointerdown" ? 1 : 0;
    element.setPointerCapture = () => {};  // there is no such pointer
    element.dispatchEvent(new PointerEvent(kind, { clientX: left + x, clientY: top + y, buttons }));
    """
    browser.execute_script(script, selector, kind, x, y)


def test_the_slider_moves_all_pictures(browser: webdriver.Chrome, strip_page: Path) -> None:
    show(browser, strip_page)
    last = pictures(browser)
    slider(browser).send_keys(Keys.ARROW_LEFT)
    before = pictures(browser)
    assert all(before[name] != last[name] for name in last)
    readout = slider(browser).get_attribute("aria-valuetext") or ""
    assert readout.startswith("20° · M = ")
    assert browser.find_element(By.CSS_SELECTOR, ".state-readout").get_property("textContent") == readout
    slider(browser).send_keys(Keys.ARROW_RIGHT)
    assert pictures(browser) == last


def test_keys_reach_every_stored_state(browser: webdriver.Chrome, strip_page: Path) -> None:
    show(browser, strip_page)
    reached = []
    for key in (Keys.HOME, Keys.ARROW_RIGHT, Keys.ARROW_UP, Keys.END):
        slider(browser).send_keys(key)
        reached.append((slider(browser).get_attribute("aria-valuetext") or "").partition("°")[0])
    assert reached == ["0", "10", "20", "30"]
    # from the top of the page the Tab key leads there too, by way of the play button
    show(browser, strip_page)
    browser.find_element(By.TAG_NAME, "body").send_keys(Keys.TAB, Keys.TAB)
    assert browser.switch_to.active_element == slider(browser)


def test_a_click_on_the_curve_chooses_the_state_next_to_it(
    browser: webdriver.Chrome, strip_page: Path
) -> None:
    show(browser, strip_page)
    width = browser.execute_script("return document.querySelector('canvas.curve').clientWidth")
    # the first third of the curve; the states are at 0, 10, 20 and 30 degrees
    point(browser, "canvas.curve", "pointerdown", width * 0.4, 100)
    assert (slider(browser).get_attribute("aria-valuetext") or "").startswith("10°")
    point(browser, "canvas.curve", "pointermove", width * 0.55, 100)
    readout = browser.find_element(By.CSS_SELECTOR, ".curve-readout").text
    assert readout.startswith("15°")  # a step, whose state is not stored
    assert (slider(browser).get_attribute("aria-valuetext") or "").startswith("10°")


def test_buttons_show_a_part_and_play_the_states(browser: webdriver.Chrome, strip_page: Path) -> None:
    show(browser, strip_page)
    whole = picture(browser, "tractions")
    _, close = browser.find_elements(By.CSS_SELECTOR, ".side-views button")
    close.click()
    assert close.get_attribute("aria-pressed") == "true"
    assert picture(browser, "tractions") != whole
    play = browser.find_element(By.CSS_SELECTOR, ".play")
    play.click()  # at the end, so that it begins from the start
    assert slider(browser).get_attribute("value") == "0"
    assert play.get_attribute("aria-label") == "pause"
    play.click()
    assert play.get_attribute("aria-label") == "play"


def test_the_stress_under_the_pointer_is_that_of_the_run(browser: webdriver.Chrome, strip_page: Path) -> None:
    show(browser, strip_page)
    (stored,) = read_stages(strip_page.parent)
    displacement = stored.run.nearest(30.0).displacement
    # the middle of an element, near the front and of a stress that is not small
    fields = sample_fields(stored.stage.problem, stored.spaces, displacement, (2, 2))
    x, y = fields.position[29, 0, 1, 1]
    axes = """
    const content = JSON.parse(document.getElementById("content").textContent).stages["stage-1"];
    const [l, r, b, t] = content.states.at(-1).faces[0].front;
    const canvas = document.querySelector("canvas.front");
    const axes = new Axes(canvas, [l, r], [b, t], { x: "x / L₀", y: "y / L₀" }, { equal: true });
    return [axes.x(arguments[0]), axes.y(arguments[1]), content.scale];
    """
    px, py, scale = browser.execute_script(axes, float(x), float(y))
    point(browser, "canvas.front", "pointermove", px, py)
    readout = browser.find_element(By.CSS_SELECTOR, ".front-readout").text
    shown = float(readout.removeprefix("I₁ = ").replace("−", "-"))
    # a level of 127 each way, two digits, and a dot of the screen: of all stress 3 % together
    assert shown == pytest.approx(float(fields.first_invariant[29, 0, 1, 1]), abs=0.03 * scale)
    assert abs(shown) > 0.1 * scale


def test_the_script_unpacks_what_was_packed(browser: webdriver.Chrome, strip_page: Path) -> None:
    show(browser, strip_page)
    script = """
    const content = JSON.parse(document.getElementById("content").textContent).stages["stage-1"];
    const state = unpackedState(content.states[1]);
    return [Array.from(state.bodies[0].nodes), content.states[1].bodies[0].nodes.unit];
    """
    nodes, unit = browser.execute_script(script)
    (stored,) = read_stages(strip_page.parent)
    fields = sample_fields(stored.stage.problem, stored.spaces, stored.run.nearest(10.0).displacement, (8, 8))
    corners = fields.position[[0, -1], [0, -1], [0, -1], [0, -1]]
    found = np.array(nodes).reshape(-1, 2)[[0, -1]]
    # half a unit each way, and the round-off of sums
    assert np.abs(found - corners).max() <= 0.5 * unit * (1 + 1e-9)


LAYOUT = """
const wide = (element) => element.closest(".wide, .numbers, canvas");
const beyond = [...document.querySelectorAll("main *")].filter(
  (element) => !wide(element) && element.getBoundingClientRect().right > innerWidth + 0.5);
const hasText = (element) => [...element.childNodes].some((node) => node.nodeType === 3 && node.data.trim());
const texts = [...document.querySelectorAll("main *")].filter(
  (element) => element.checkVisibility() && hasText(element));
const numbers = (color) => color.match(/[\\d.]+/g).map(Number);
const behind = (element) => {
  for (let at = element; at; at = at.parentElement) {
    const color = numbers(getComputedStyle(at).backgroundColor);
    if (color.length === 3 || color[3] > 0) return color.slice(0, 3);
  }
};
return {
  width: document.documentElement.scrollWidth,
  beyond: beyond.map((element) => element.outerHTML.slice(0, 80)),
  sizes: [...texts.map((element) => parseFloat(getComputedStyle(element).fontSize)), parseFloat(FONT)],
  texts: texts.map((element) =>
    [element.textContent.trim().slice(0, 40), numbers(getComputedStyle(element).color), behind(element)]),
  canvas: colors(),
};
"""


@pytest.mark.parametrize("size", [DESKTOP, PHONE])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_reads_well_on_phones_and_in_the_dark(
    browser: webdriver.Chrome, strip_page: Path, size: tuple[int, int], scheme: str
) -> None:
    show(browser, strip_page, size, scheme)
    browser.execute_script("document.querySelector('details').open = true")
    found = browser.execute_script(LAYOUT)
    assert found["beyond"] == []
    assert found["width"] <= size[0]  # less by a scroll bar on a desktop
    assert min(found["sizes"]) >= SMALLEST_TEXT
    assert len(found["texts"]) > 50
    pale = [text for text, color, behind in found["texts"] if contrast(color, behind) < TEXT_CONTRAST]
    assert pale == []
    canvas = {name: channels(color) for name, color in found["canvas"].items()}
    for name, least in (
        ("ink", TEXT_CONTRAST),
        ("quiet", TEXT_CONTRAST),
        ("curve", GRAPHICS_CONTRAST),
        ("mark", GRAPHICS_CONTRAST),
    ):
        assert contrast(canvas[name], canvas["paper"]) >= least, name
    dark = luminance(canvas["paper"]) < 0.05
    assert dark == (scheme == "dark")


def channels(color: str) -> list[float]:
    digits = color.removeprefix("#")
    if len(digits) == 3:
        digits = "".join(2 * digit for digit in digits)
    return [float(int(digits[k : k + 2], 16)) for k in (0, 2, 4)]


def luminance(color: list[float]) -> float:
    """Relative luminance, as the Web Content Accessibility Guidelines define it."""
    share = np.array(color) / 255
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    return float(linear @ (0.2126, 0.7152, 0.0722))


def contrast(one: list[float], other: list[float]) -> float:
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


def test_buttons_choose_one_of_several_interfaces(browser: webdriver.Chrome, tmp_path: Path) -> None:
    show(browser, write_html_report(two_bodies(tmp_path)))
    first, second = browser.find_elements(By.CSS_SELECTOR, ".interface-views button")
    assert [first.text, second.text] == ["one.bottom", "other.bottom"]
    before = pictures(browser)
    second.click()
    after = pictures(browser)
    changed = [name for name in before if before[name] != after[name]]
    # the frame around the front moves in the picture of the bodies
    assert changed == ["body", "front", "tractions"]
    # the body that rests is drawn where it is, without a stress
    script = """
    const content = JSON.parse(document.getElementById("content").textContent).stages["stage-1"];
    const { bodies } = unpackedState(content.states.at(-1));
    return bodies.map(({ nodes, stress }) => [nodes[0], new Set(stress).size]);
    """
    (left, levels), (right, one_level) = browser.execute_script(script)
    assert (left, right) == pytest.approx((0.0, 50.0), abs=1e-3)  # a step of positions in the page
    assert levels > 100
    assert one_level == 1
    # what one interface has needs no button
    show(browser, write_html_report(strip(tmp_path / "strip")))
    assert not browser.find_element(By.CSS_SELECTOR, ".interface-views").is_displayed()


def test_each_stage_has_its_own_slider(browser: webdriver.Chrome, staged_page: Path) -> None:
    show(browser, staged_page)
    first, second = pictures(browser, 1), pictures(browser, 2)
    slider(browser, 2).send_keys(Keys.HOME)
    assert pictures(browser, 1) == first
    assert pictures(browser, 2)["body"] != second["body"]
    links: list[Any] = browser.find_elements(By.CSS_SELECTOR, "main a[href='#stage-2']")
    assert [link.text for link in links] == ["press-and-peel, stage 2: peel"]


def test_a_failed_run_is_reported(browser: webdriver.Chrome, tmp_path: Path) -> None:
    show(browser, write_html_report(failed(tmp_path)))
    readout = browser.find_element(By.CSS_SELECTOR, ".ending").text
    assert readout.startswith("No equilibrium at 40°: ")
    assert "Remedy: " in readout
    assert browser.find_element(By.CSS_SELECTOR, "canvas.curve").is_displayed()


def test_without_a_script_its_numbers_are_there(browser: webdriver.Chrome, strip_page: Path) -> None:
    show(browser, strip_page, script=False)
    text = browser.find_element(By.TAG_NAME, "main").text
    for words in (
        "of this page need JavaScript",
        "Completed: 7 steps, to 30°.",
        "largest moment",
        "beam theory",
    ):
        assert words in text
    assert 'mesh = "40x2"' in text
    assert not browser.find_element(By.CSS_SELECTOR, "canvas.curve").is_displayed()
