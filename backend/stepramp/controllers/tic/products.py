"""Settings that differ from one Tic to the other: its serial port doesn't tell which one it is (section 6)."""

from collections.abc import Callable

from stepramp.controllers.tic.settings import END, PRODUCT, Setting, flag, word

T500_CURRENTS_MA = (
    0, 1, 174, 343, 495, 634, 762, 880, 990, 1092, 1189, 1281, 1368, 1452, 1532, 1611, 1687, 1762, 1835, 1909, 1982,
    2056, 2131, 2207, 2285, 2366, 2451, 2540, 2634, 2734, 2843, 2962, 3093,
)  # fmt: skip
AS_WITHOUT_ERROR = 0xFF
"""In the place of a current limit during errors."""
LIMIT, LIMIT_DURING_ERROR, DECAY = 0x40, 0x31, 0x42
T825_DECAYS = ("mixed", "slow", "fast")
T834_DECAYS = ("mixed50", "slow", "fast", "mixed25", "mixed75")
AGC = (
    Setting("agc_mode", (0x6C,), word(("off", "on", "active_off"))),
    Setting("agc_bottom_current_limit", (0x6D,), word(("45", "50", "55", "60", "65", "70", "75", "80"))),
    Setting("agc_current_boost_steps", (0x6E,), word(("5", "7", "9", "11"))),
    Setting("agc_frequency_limit", (0x6F,), word(("off", "225", "450", "675"))),
)
HP = (Setting("hp_enable_unrestricted_current_limits", (0x6C,), flag()),)
HP_NOT_READ = ("hp_toff", "hp_tblank", "hp_abt", "hp_tdecay", "hp_decmod")
"""Those of a 36v4 that lie beyond what a serial port is asked for."""


def _in_32_ma(highest: int) -> Callable[[int], int]:
    """Return the current of a DRV8825 or DRV8834 [mA]: in coarser steps the higher it is."""

    def current_ma(code: int) -> int:
        coarse = 4 if code > 64 else 2 if code > 32 else 1
        return 32 * (highest if code > highest else code // coarse * coarse)

    return current_ma


def _t500_ma(code: int) -> int:
    return T500_CURRENTS_MA[min(code, len(T500_CURRENTS_MA) - 1)]


def _t249_ma(code: int) -> int:
    return 40 * min(code, 112)


def _36v4_ma(code: int) -> int:
    return (55_000 * min(code, 127) + 384) // 768


def _currents(current_ma: Callable[[int], int]) -> tuple[Setting, ...]:
    return (
        Setting("current_limit", (LIMIT,), lambda code: str(current_ma(code))),
        Setting(
            "current_limit_during_error",
            (LIMIT_DURING_ERROR,),
            lambda code: "-1" if code == AS_WITHOUT_ERROR else str(current_ma(code)),
        ),
    )


def _decay(words: tuple[str, ...]) -> Setting:
    return Setting("decay_mode", (DECAY,), word(words))


PRODUCTS = {
    "T825": (*_currents(_in_32_ma(124)), _decay(T825_DECAYS)),
    "T834": (*_currents(_in_32_ma(108)), _decay(T834_DECAYS)),
    "T500": _currents(_t500_ma),
    "N825": (*_currents(_in_32_ma(124)), _decay(T825_DECAYS)),
    "T249": (*_currents(_t249_ma), *AGC),
    "36v4": (*_currents(_36v4_ma), *HP),
}
"""By the names of a settings file."""
CODES = tuple(
    Setting(name, (address,), lambda code: f"code {code}")
    for name, address in (
        ("current_limit", LIMIT),
        ("current_limit_during_error", LIMIT_DURING_ERROR),
        ("decay_mode", DECAY),
        *((f"byte {address:#04x}", address) for address in range(PRODUCT, END)),
    )
)
"""The same as they are kept, whichever product it is: T249 and 36v4 mean different things by the same address."""
