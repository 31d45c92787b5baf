"""Numbers as the paper writes them."""


def digits(value: float, count: int) -> str:
    """A number with so many significant digits, with an exponent only where it is shorter: 3.49e-6, 0.0581."""
    mantissa, _, exponent = f"{value:.{count - 1}e}".partition("e")
    power = int(exponent)
    return f"{value:.{max(0, count - 1 - power)}f}" if -2 <= power <= 2 else f"{mantissa}e{power}"


def short(value: float) -> str:
    """A round number: 0.025, 2.5e-4, 1e7."""
    mantissa, _, exponent = f"{value:.1e}".partition("e")
    return f"{value:g}" if 1e-3 <= value < 1e4 else f"{mantissa.removesuffix('.0')}e{int(exponent)}"
