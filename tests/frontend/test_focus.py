"""Where the focus goes when the button that has it can't be used any more, or goes."""

from itertools import permutations, product

import pytest

from frontend.modules import Modules

PRESSED = """async ([events, fixups]) => {
    const {enable, handOn} = await import('/panels/device/section.js');
    const body = {};
    const page = {body, activeElement: body};
    const button = () => ({
        disabled: false, hidden: false,
        focus() { if (!this.disabled && !this.hidden) page.activeElement = this; },
        blur() { if (page.activeElement === this) page.activeElement = body; },
    });
    const own = globalThis.document;
    globalThis.document = page;
    const [push, rollBack] = [button(), button()];
    rollBack.focus();
    const state = {isBusy: false, isGone: false};
    const show = () => {
        enable(push, !state.isBusy);
        rollBack.hidden = state.isGone;
        if (rollBack.hidden) handOn([rollBack], push);
        enable(rollBack, !state.isBusy);
    };
    events.forEach((event, index) => {
        Object.assign(state, event);
        show();
        // A browser takes the focus from what can't have it when it paints next, which may be at once or later.
        const {activeElement} = page;
        if (fixups[index] && (activeElement.disabled || activeElement.hidden)) page.activeElement = body;
    });
    globalThis.document = own;
    return page.activeElement === push;
}"""
BUSY, FREE, GONE = {"isBusy": True}, {"isBusy": False}, {"isGone": True}
ORDERS = [order for order in permutations([BUSY, FREE, GONE]) if order.index(BUSY) < order.index(FREE)]


@pytest.mark.parametrize("paints", list(product([True, False], repeat=3)), ids=str)
@pytest.mark.parametrize("order", ORDERS, ids=["busy, free, gone", "busy, gone, free", "gone, busy, free"])
def test_a_button_that_goes_hands_its_focus_on(
    modules: Modules, order: tuple[dict[str, bool], ...], paints: tuple[bool, ...]
) -> None:
    assert modules.evaluate(PRESSED, [list(order), list(paints)])
