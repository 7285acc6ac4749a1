"""Draws charts with two logarithmic axes, side by side, as one SVG picture."""

import html
import math

WIDTH, HEIGHT = 420, 340  # Size of a chart.
LEFT, RIGHT, TOP, BOTTOM = 58, 20, 34, 44  # Margins around its frame.
COLOURS = ("#1f5fbf", "#56b4e9", "#c44e00", "#e6a23c")


def bounds(values):
    """Returns the powers of ten around all values."""
    return 10.0 ** math.floor(math.log10(min(values))), 10.0 ** math.ceil(math.log10(max(values) * 1.0001))


def powers(low, high):
    return [10.0 ** e for e in range(round(math.log10(low)), round(math.log10(high)) + 1)]


def label(value):
    return f"{value:g}" if value < 1e5 else f"10^{round(math.log10(value))}"


def text(x, y, what, anchor="middle", extra=""):
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{extra}>{html.escape(what)}</text>'


def chart(title, axes, series, x_range, y_range, x_ticks, is_line):
    """Returns a chart as SVG. `series` is {name: [(x, y)]}; colours follow its order."""
    def place(value, span, start, length):
        return start + length * (math.log(value / span[0]) / math.log(span[1] / span[0]))

    def at(x, y):
        return (place(x, x_range, LEFT, WIDTH - LEFT - RIGHT),
                place(y, y_range, HEIGHT - BOTTOM, -(HEIGHT - TOP - BOTTOM)))

    bottom, right = HEIGHT - BOTTOM, WIDTH - RIGHT
    parts = [text((LEFT + right) / 2, 18, title, extra=' font-weight="bold"')]
    for tick in x_ticks:
        x = at(tick, y_range[0])[0]
        parts += [f'<path d="M{x:.1f} {TOP}V{bottom}" stroke="#ddd"/>', text(x, bottom + 16, label(tick))]
    for tick in powers(*y_range):
        y = at(x_range[0], tick)[1]
        parts += [f'<path d="M{LEFT} {y:.1f}H{right}" stroke="#ddd"/>', text(LEFT - 6, y + 4, label(tick), "end")]
    parts += [text((LEFT + right) / 2, HEIGHT - 8, axes[0]),
              text(14, HEIGHT / 2, axes[1], extra=f' transform="rotate(-90 14 {HEIGHT / 2})"')]
    for colour, points in zip(COLOURS, series.values()):
        places = [at(x, y) for x, y in sorted(points)]
        if is_line and places:
            parts.append(f'<polyline fill="none" stroke="{colour}" stroke-width="1.5" points="'
                         + " ".join(f"{x:.1f},{y:.1f}" for x, y in places) + '"/>')
        parts += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.6" fill="{colour}" fill-opacity="0.8"/>' for x, y in places]
    return "".join(parts)


def draw(path, axes, charts, x_ticks=None, is_line=False):
    """Writes charts as a picture. `charts` is {title: series}, all with the same names; they share their scales."""
    points = [point for series in charts.values() for values in series.values() for point in values]
    if not points:
        return
    x_range = (min(x_ticks) / 1.1, max(x_ticks) * 1.1) if x_ticks else bounds([x for x, _ in points])
    y_range = bounds([y for _, y in points])
    width, height = WIDTH * len(charts), HEIGHT + 24
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}" '
             'font-family="sans-serif" font-size="11"><rect width="100%" height="100%" fill="white"/>']
    for index, (title, series) in enumerate(charts.items()):
        body = chart(title, axes, series, x_range, y_range, x_ticks or powers(*x_range), is_line)
        parts.append(f'<g transform="translate({index * WIDTH} 0)">{body}</g>')
    for index, name in enumerate(next(iter(charts.values()))):
        x = LEFT + 180 * index
        parts += [f'<circle cx="{x}" cy="{HEIGHT + 8}" r="4" fill="{COLOURS[index]}"/>', text(x + 9, HEIGHT + 12, name, "start")]
    path.write_text("".join(parts) + "</svg>\n")
