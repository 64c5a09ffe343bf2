"""Choosing the model in the page."""

from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from labeler.models import ModelCache
from tests.browser.serving import models_of

pytestmark = pytest.mark.browser


def test_a_model_is_chosen_and_named(
    page: Page, serve: Callable[..., str], made_drive: Path, made_model: Path, tmp_path: Path
) -> None:
    ModelCache(models_of(tmp_path / "workspace")).add(made_model, "mine")
    page.goto(serve(str(made_drive)))
    card = page.get_by_role("listitem").filter(has_text="made drive")

    # Nobody asked for a model: the one that ships would be used, and says what it is good for.
    expect(card).to_contain_text("model sim-yolox-nano")
    expect(card).to_contain_text("trained on simulated drives")
    expect(card).to_contain_text("Not labelled")

    card.get_by_role("button", name="Choose the model").click()
    menu = page.get_by_role("menu")
    expect(menu.get_by_role("menuitem").nth(0)).to_contain_text("sim-yolox-nano ships with Hindsight, default")
    menu.get_by_role("menuitem", name="mine added").click()
    expect(card).to_contain_text("labelled by mine", timeout=60_000)
    expect(card).not_to_contain_text("trained on simulated drives")

    # A labelled drive can be labelled again with another model.
    card.get_by_role("button", name="More actions").click()
    expect(page.get_by_role("menuitem", name="sim-yolox-nano")).to_be_visible()
    page.get_by_role("menuitem", name="mine added").click()
    expect(card).to_contain_text("labelled by mine", timeout=60_000)
