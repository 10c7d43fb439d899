"""A page holds what was run, loads nothing, and shows what comes from a run as the text that it is."""

import json
import re
from base64 import b64decode, b64encode
from dataclasses import replace
from hashlib import sha256
from html import unescape
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from runs import failed, staged, strip

from isopeel import InputError
from isopeel.cli import main
from isopeel.html_report import content
from isopeel.html_report.content import plain, stage_content
from isopeel.html_report.markup import curve_legend
from isopeel.html_report.region import substrate_region
from isopeel.html_report.write import html_report, write_html_report
from isopeel.physics.substrates import Circle, Flat
from isopeel.post.fields import sample_fields
from isopeel.post.findings import find
from isopeel.post.states import Window
from isopeel.results.run_file import Ending, StoredRun, read_run, write_run
from isopeel.running.run_reader import StoredStage, read_stages
from isopeel.solve.step import KINDS

# elements that may stay open
VOID = {"meta", "link", "input", "br"}

# a page draws its own pictures
pytestmark = pytest.mark.usefixtures("without_figures")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return strip(tmp_path_factory.mktemp("strip"))


@pytest.fixture(scope="module")
def stage(folder: Path) -> StoredStage:
    (stored,) = read_stages(folder)
    return stored


def contents(stage: StoredStage, most_bytes: int = 4_000_000) -> content.Content:
    return stage_content(stage, find(stage.stage.problem, stage.spaces, stage.run, None), most_bytes)


class Elements(HTMLParser):
    """The elements of a page, whether all are closed in their order, and the text in each kind."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.open: list[str] = []
        self.attributes: list[tuple[str, str, str]] = []
        self.texts: dict[str, list[str]] = {}
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.attributes += [(tag, name, value or "") for name, value in attrs]
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open:
            self.texts.setdefault(self.open[-1], []).append(data)


def test_a_page_loads_nothing_and_runs_its_own_script_alone(stage: StoredStage) -> None:
    text = html_report((stage,))
    found = Elements(text)
    loading = {("link", "href"), ("img", "src"), ("script", "src"), ("a", "href")}
    urls = [value for tag, name, value in found.attributes if (tag, name) in loading]
    assert urls == ["data:,"]
    assert "url(" not in text
    assert "@import" not in text
    # no attribute is a script or a style, which the policy would not let through
    assert [name for _, name, _ in found.attributes if name.startswith("on") or name == "style"] == []
    (policy,) = [value for tag, name, value in found.attributes if "default-src" in value]
    assert policy.startswith("default-src 'none'; ")
    for element in ("style", "script"):
        inside = re.findall(f"<{element}>(.*?)</{element}>", text, re.DOTALL)
        digests = [b64encode(sha256(part.encode()).digest()).decode() for part in inside]
        assert [f"{element}-src 'sha256-{digest}'" in policy for digest in digests] == [True]


def test_what_comes_from_a_run_is_shown_as_text(stage: StoredStage) -> None:
    mark = '</code></script><script>alert("&amp;")</script>'
    run = replace(
        stage.run,
        case_text=stage.run.case_text + f"# {mark}\n",
        attributes={**stage.run.attributes, "command_line": mark, "L0": mark},
    )
    case = stage.case.model_copy(update={"about": mark})
    found = Elements(html_report((replace(stage, run=run, title=mark, case=case),)))
    assert len(found.texts["script"]) == 2  # the numbers and the script
    assert mark in found.texts["h1"][0]
    assert [text for text in found.texts["code"] if mark in text]
    assert [text for text in found.texts["td"] if text == mark]
    numbers = json.loads(found.texts["script"][0])
    assert numbers["stages"]["stage-1"]["title"] == mark


def test_a_page_shows_the_stored_states_at_their_steps(stage: StoredStage) -> None:
    shown = contents(stage)
    assert [state["step"] for state in shown["states"]] == [0, 2, 4, 6]
    assert shown["grids"] == [[40, 2, 8, 8]]
    stress = np.frombuffer(b64decode(shown["states"][-1]["bodies"][0]["stress"]), np.uint8)
    exact = sample_fields(
        stage.stage.problem, stage.spaces, stage.run.nearest(30.0).displacement, (8, 8)
    ).first_invariant
    # rounded to whole levels, 127 each way
    assert np.abs((stress.reshape(exact.shape) / 127 - 1) * shown["scale"] - exact).max() <= (
        0.5 / 127 * shown["scale"] * (1 + 1e-9)
    )


def test_states_are_left_out_where_there_is_no_room(stage: StoredStage) -> None:
    shown = contents(stage)
    size = len(json.dumps(shown["states"][-1]))
    less = contents(stage, int(3.5 * size))
    assert [state["step"] for state in less["states"]] == [0, 4, 6]
    assert less["stored"] == 4
    # the first and the last are always there
    assert [state["step"] for state in contents(stage, 1)["states"]] == [0, 6]


def path(run: StoredRun, parameters: list[float], fields: list[float]) -> StoredRun:
    """A run with other parameters, and displacements at some of them, that have no meaning."""
    curve, number = run.curve, len(parameters)
    whole = {"kind", "negative_eigenvalues", "iterations"}
    columns: dict[str, Any] = {name: np.zeros(number, dtype=np.int64) for name in whole}
    others = {"parameter_column", "reaction_column", "sensitive_to", "sensitivities"}
    for name in vars(curve).keys() - whole - others:
        columns[name] = np.zeros(number)
    columns |= {"parameter": np.array(parameters), "energy_residuals": np.empty(0)}
    states = [run.states[0]._replace(step=parameters.index(at), parameter=at) for at in fields]
    return replace(run, curve=replace(curve, **columns), states=tuple(states))


def test_branches_and_jumps_are_reported_apart(stage: StoredStage) -> None:
    kinds = ("requested", "limit point", "between", "limit point", "requested", "jump")
    run = path(stage.run, [0.0, 2.0, 1.8, 1.5, 3.0, 3.0], [0.0, 3.0])
    curve = replace(
        run.curve,
        kind=np.array([KINDS.index(kind) for kind in kinds]),
        negative_eigenvalues=np.array([0, 0, 1, 0, 0, 0]),
        reaction=np.array([0.0, 1.0, 0.9, 0.8, 1.1, 0.7]),
    )
    stored = replace(stage, run=replace(run, curve=curve))
    shown = contents(stored)
    # before each step: unstable between the limit points, and a jump to the last
    assert list(b64decode(shown["curve"]["pieces"])) == [0, 0, 1, 1, 0, 2]
    whole, turn = shown["views"]
    assert (whole["name"], turn["name"]) == ("whole", "widest snap-back")
    # as wide again on either side
    assert turn["x"] == pytest.approx([1.0, 2.5])
    legend = curve_legend(stored, plateau=False)
    assert re.findall("</span>([a-z ]+)</span>", legend) == [
        "stored state",
        "selected state",
        "unstable",
        "jump",
        "limit point",
    ]


def test_what_is_no_number_is_refused(folder: Path, tmp_path: Path) -> None:
    run = read_run(folder / "run.h5")
    last = run.states[-1]
    states = (*run.states[:-1], last._replace(displacement=np.full_like(last.displacement, np.nan)))
    reaction = np.where(run.curve.parameter > 20, np.inf, run.curve.reaction)
    for changed, message in (
        (replace(run, states=states), "/fields/displacement has numbers that are not finite"),
        (
            replace(run, curve=replace(run.curve, reaction=reaction)),
            "curve/reaction has numbers that are",
        ),
    ):
        write_run(tmp_path / "run.h5", changed)
        with pytest.raises(InputError, match=message):
            write_html_report(tmp_path)
    assert not (tmp_path / "report.html").exists()


def test_the_region_of_a_substrate_has_its_area() -> None:
    window = Window((-2.0, 2.0), (-2.0, 2.0))
    rings, surface = substrate_region(Flat(), window)
    assert area(rings) == pytest.approx(8.0, abs=1e-4)  # six digits
    assert [y for line in surface for y in line[1::2]] == pytest.approx([0.0] * 501, abs=1e-9)
    rings, _ = substrate_region(Circle(radius=1.5), window)
    # chords of a hundredth take 1e-5 of a circle, and its top touches the origin
    disc = np.pi * 1.5**2
    assert 0 < area(rings) < disc


def area(rings: list[list[float]]) -> float:
    """By the shoelace formula, holes counted negative as they turn the other way."""
    total = 0.0
    for ring in rings:
        x, y = np.array(ring).reshape(-1, 2).T
        total += float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2
    return abs(total)


def test_units_are_shown_without_mathematical_type() -> None:
    assert plain("moment $M$") == "moment M"
    assert (plain("E0 L0^3"), plain("E0 L0"), plain("degree")) == ("E₀ L₀³", "E₀ L₀", "°")


def test_the_command_writes_one_page_for_all_stages(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = staged(tmp_path / "run")
    assert main(["report", str(run)]) == 0
    assert capsys.readouterr().out == f"the report is {run / 'report.html'}\n"
    text = (run / "report.html").read_text("utf-8")
    assert {"stage-1", "stage-2"} <= {value for _, name, value in Elements(text).attributes if name == "id"}
    other = tmp_path / "other.html"
    assert main(["report", str(run / "2-peel"), "--out", str(other)]) == 0
    assert "press-and-peel, stage 2: peel" in other.read_text("utf-8")
    # a new run makes the page an old one
    staged(run)
    assert not (run / "report.html").exists()


def test_the_command_refuses_in_one_line(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cases: list[tuple[list[str], str]] = [
        ([str(tmp_path / "nowhere")], "it is not a folder"),
        ([str(tmp_path)], "there is no run.h5 in it"),
        ([str(folder), "--out", str(tmp_path)], "it is a folder, which is never replaced"),
        ([str(folder), "--out", str(tmp_path / "no" / "a.html")], "cannot be written"),
    ]
    for arguments, message in cases:
        assert main(["report", *arguments]) == 2
        error = capsys.readouterr().err
        assert message in error
        assert error.count("\n") == 1


def test_runs_that_did_not_end_are_reported(stage: StoredStage, tmp_path: Path) -> None:
    def message(stage: StoredStage) -> str:
        return unescape(re.sub("<[^>]*>", "", html_report((stage,))))

    def ended(ending: Ending) -> str:
        return message(replace(stage, run=replace(stage.run, ending=ending)))

    assert "Completed: 7 steps, to 30°." in ended("completed")
    assert "This run was interrupted" in ended("interrupted")
    assert "This run was killed" in ended("running")
    (stopped,) = read_stages(failed(tmp_path))
    assert stopped.run.failure is not None
    text = message(stopped)
    assert f"Cause: {stopped.run.failure.cause}. Remedy: {stopped.run.failure.hint}." in text


def test_a_run_without_a_step_has_a_page_too(tmp_path: Path) -> None:
    (stopped,) = read_stages(failed(tmp_path))
    nothing = path(stopped.run, [], [])
    found = Elements(html_report((replace(stopped, run=replace(nothing, states=())),)))
    assert any("No equilibrium" in text for text in found.texts["p"])
    assert json.loads(found.texts["script"][0])["stages"] == {}
    found = Elements(html_report((replace(stopped, run=replace(stopped.run, states=())),)))
    assert json.loads(found.texts["script"][0])["stages"] == {}


def test_a_run_of_one_step_has_one_state(stage: StoredStage) -> None:
    shown = contents(replace(stage, run=path(stage.run, [0.0], [0.0])))
    assert [state["step"] for state in shown["states"]] == [0]
    left, right = shown["views"][0]["x"]
    assert left < 0.0 < right


def _recount(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The parameters of states that the page computes on a finer mesh."""
    computed: list[float] = []

    def counted(_problem: object, _space: object, run: StoredRun, _points: object = None) -> list[object]:
        computed.extend(state.parameter for state in run.states)
        return []

    monkeypatch.setattr("isopeel.html_report.write.mesh_changes", counted)
    return computed


def test_a_page_takes_the_finer_mesh_from_the_summary(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    computed = _recount(monkeypatch)
    changes = json.loads((folder / "summary.json").read_text("utf-8"))["finer_mesh"]
    assert changes
    text = html_report(read_stages(folder))
    assert not computed
    assert text.count("half of the element length") == len(changes)


@pytest.mark.parametrize(
    "damage",
    [
        lambda message: message | {"run": "0" * 32},
        lambda message: message | {"finer_mesh": [{"parameter": 1}]},
        lambda message: (
            message | {"finer_mesh": [one | {"on_finer_mesh": "x"} for one in message["finer_mesh"]]}
        ),
        lambda message: (
            message | {"finer_mesh": [one | {"on_finer_mesh": 1e999} for one in message["finer_mesh"]]}
        ),
        lambda message: message | {"finer_mesh": 5},
        lambda message: [message],
    ],
    ids=["another run", "no numbers", "text", "infinity", "no list", "no table"],
)
def test_a_summary_that_is_not_of_the_run_is_not_believed(
    folder: Path, monkeypatch: pytest.MonkeyPatch, damage: Any
) -> None:
    computed, file = _recount(monkeypatch), folder / "summary.json"
    message = file.read_text("utf-8")
    try:
        file.write_text(json.dumps(damage(json.loads(message))), "utf-8")
        html_report(read_stages(folder))
        assert computed
    finally:
        file.write_text(message, "utf-8")
