"""Ask for what a new case needs, and write it."""

from collections.abc import Callable, Mapping
from pathlib import Path
from shlex import quote

from rich.console import Console

from isopeel.common.errors import InputError
from isopeel.output.cases import write_new
from isopeel.output.new_case import TESTS, Question, new_case

#: Asks a question with a default, and returns the answer.
Ask = Callable[[str, str | None], str]


def write_new_case(
    test: str | None, given: Mapping[str, str], out: Path | None, console: Console, ask: Ask | None
) -> None:
    """Write the case of a test to a file that does not exist, by the given answers and those asked for.

    Without `ask`, defaults are taken. Raises InputError that names the first option that is missing, that
    does not belong to the test, or that cannot be used, and OSError where the file cannot be written.
    """
    if test is None and ask is not None:
        for name, one in TESTS.items():
            console.print(f"{name}: {one.about}", soft_wrap=True)
        test = ask("test", "tape")
    if test is None or test not in TESTS:
        raise InputError("TEST", test, f"one of these tests is needed: {', '.join(TESTS)}")
    questions = TESTS[test].questions
    for option in given:
        if option not in {one.option for one in questions} | {"strength", "width"}:
            names = ", ".join(one.name for one in questions)
            allowed = f"{test} has no such option; it has {names}, --strength, --width"
            raise InputError(f"--{option.replace('_', '-')}", given[option], allowed)
    answers = {one.option: given.get(one.option) or _answer(one, ask, console) for one in questions}
    text = new_case(test, {**answers, **given})
    file = out or Path(f"{test}.toml")
    write_new(file, text, "--out")
    console.print(f"{file}: `isopeel run {quote(str(file))}` runs it", soft_wrap=True)


def _answer(question: Question, ask: Ask | None, console: Console) -> str:
    """Return the answer to a question, which is asked again until it can be used."""
    if ask is None:
        if question.usual is None:
            raise InputError(question.name, None, f"the option is missing; {question.dimension.needed}")
        return question.usual
    while True:
        answer = ask(question.text, question.usual)
        try:
            question.read(answer)
        except InputError as error:
            console.print(str(error), soft_wrap=True)
        else:
            return answer
