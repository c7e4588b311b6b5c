"""Draws diagrams as SVG files with the standard library alone. The bytes are always the same.

Lengths on the page are in pixels. A panel maps scene coordinates, with y upwards, to the page.
Labels are plain text with $mathematics$: letters in italics, `_x` or `_{xyz}` as subscripts.
"""

import math
import re
import xml.sax.saxutils

from eses_tools.common import Failed

# Colours of Okabe and Ito, which colour-blind readers can distinguish, and light tints of them.
BLUE, ORANGE, GREEN, PURPLE = "#0072B2", "#D55E00", "#009E73", "#9A5580"
LIGHT_BLUE, LIGHT_ORANGE, LIGHT_GREEN = "#D6E8F4", "#FBE3D3", "#D3EFE5"
BLACK, DARK, GREY, LIGHT = "#222222", "#444444", "#8A8A8A", "#ECECEC"

FONT_SIZE = 14
SUBSCRIPT_SIZE = 10.5
SPACE_WIDTH = 4.5
LETTER_WIDTH = 0.56  # share of the font size: the average of a sans-serif font, with some room


def number(value):
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def on_circle(center, radius, angle):
    return center[0] + radius * math.cos(angle), center[1] + radius * math.sin(angle)


def toward(start, end, length):
    """Returns the point at a distance from `start` on the way to `end`."""
    share = length / math.dist(start, end)
    return start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1])


def segments(label):
    """Yields the parts of a label: text, whether it is in italics, whether it is a subscript."""
    for index, part in enumerate(label.split("$")):
        if index % 2 == 0:
            if part:
                yield part, False, False
            continue
        for subscript, other in re.findall(r"_(\{[^}]*\}|.)|([^_]+)", part):
            if subscript:
                yield subscript.strip("{}"), True, True
            else:
                yield other, True, False


def label_width(label):
    return LETTER_WIDTH * sum(len(text) * (SUBSCRIPT_SIZE if is_subscript else FONT_SIZE)
                              for text, _, is_subscript in segments(label))


def attributes(values):
    return "".join(f' {name.replace("_", "-")}={xml.sax.saxutils.quoteattr(str(value))}'
                   for name, value in values.items())


def shape_style(stroke=None, fill=None, width=1.5, dash=None, opacity=None):
    style = {"fill": fill or "none"}
    if stroke:
        style.update(stroke=stroke, stroke_width=number(width))
    if dash:
        style["stroke_dasharray"] = dash
    if opacity is not None:
        style["fill_opacity"] = number(opacity)
    return attributes(style)


class Diagram:
    def __init__(self, width, height, title):
        self.width, self.height, self.title = width, height, title
        self.elements = []
        self.labels = []  # with their boxes: left, top, right, bottom

    def add(self, element):
        self.elements.append(element)

    def label(self, x, y, text, anchor="start", color=BLACK):
        """Writes a label with its vertical middle at `y`."""
        width = label_width(text)
        left = x - {"start": 0, "middle": width / 2, "end": width}[anchor]
        self.labels.append((text, (left, y - 0.55 * FONT_SIZE, left + width, y + 0.55 * FONT_SIZE)))
        spans = ""
        lowered, space = 0, 0
        for part, is_italic, is_subscript in segments(text):
            wanted = 4 if is_subscript else 0
            style = {}
            # Renderers drop spaces at the ends of a part, so a shift replaces them.
            space += SPACE_WIDTH if part.startswith(" ") else 0
            if space:
                style["dx"] = space
            if wanted != lowered:
                style["dy"] = wanted - lowered
            if is_italic and any(letter.isalpha() for letter in part):
                style["font_style"] = "italic"
            if is_subscript:
                style["font_size"] = SUBSCRIPT_SIZE
            lowered, space = wanted, SPACE_WIDTH if part.endswith(" ") else 0
            spans += f"<tspan{attributes(style)}>{xml.sax.saxutils.escape(part.strip())}</tspan>"
        place = attributes({"x": number(x), "y": number(y + 0.35 * FONT_SIZE), "fill": color,
                            "text_anchor": anchor})
        self.add(f"<text{place}>{spans}</text>")

    def check_labels(self):
        """Throws Failed if a label leaves the page or two labels overlap."""
        for index, (text, box) in enumerate(self.labels):
            if box[0] < 0 or box[1] < 0 or box[2] > self.width or box[3] > self.height:
                raise Failed(f"{self.title}: the label '{text}' leaves the page")
            for other, other_box in self.labels[:index]:
                if (box[0] < other_box[2] and other_box[0] < box[2] and
                        box[1] < other_box[3] and other_box[1] < box[3]):
                    raise Failed(f"{self.title}: the labels '{text}' and '{other}' overlap")

    def text(self):
        self.check_labels()
        head = attributes({"xmlns": "http://www.w3.org/2000/svg", "width": self.width,
                           "height": self.height, "viewBox": f"0 0 {self.width} {self.height}",
                           "font_family": "DejaVu Sans, Verdana, Arial, sans-serif",
                           "font_size": FONT_SIZE, "role": "img"})
        title = xml.sax.saxutils.escape(self.title)
        return "\n".join([f"<svg{head}>", f"<title>{title}</title>",
                          '<rect width="100%" height="100%" fill="#FFFFFF"/>',
                          *self.elements, "</svg>", ""])


class Panel:
    """A part of a diagram with its own coordinates. `origin` is the place of (0, 0) on the page."""

    def __init__(self, diagram, origin, scale):
        self.diagram, self.origin, self.scale = diagram, origin, scale

    def page(self, point):
        return (self.origin[0] + self.scale * point[0], self.origin[1] - self.scale * point[1])

    def place(self, point):
        return " ".join(number(value) for value in self.page(point))

    def circle(self, center, radius, **style):
        x, y = self.page(center)
        place = attributes({"cx": number(x), "cy": number(y), "r": number(radius * self.scale)})
        self.diagram.add(f"<circle{place}{shape_style(**style)}/>")

    def dot(self, center, color=BLACK, pixels=3.5, is_hollow=False):
        x, y = self.page(center)
        place = attributes({"cx": number(x), "cy": number(y), "r": number(pixels)})
        style = shape_style(color, "#FFFFFF") if is_hollow else shape_style(None, color)
        self.diagram.add(f"<circle{place}{style}/>")

    def path(self, data, **style):
        self.diagram.add(f'<path d="{data}"{shape_style(**style)}/>')

    def lines(self, points, is_closed=False, **style):
        data = "M" + "L".join(self.place(point) for point in points) + ("Z" if is_closed else "")
        self.path(data, **style)

    def rectangle(self, low, high, **style):
        self.lines([low, (high[0], low[1]), high, (low[0], high[1])], is_closed=True, **style)

    def arc_data(self, center, radius, start, end):
        """Returns the part of a path that continues to the end of an arc, from its start."""
        size = number(radius * self.scale)
        is_large = 1 if abs(end - start) > math.pi else 0
        is_clockwise = 1 if end < start else 0
        return f"A{size} {size} 0 {is_large} {is_clockwise} " + self.place(
            on_circle(center, radius, end))

    def arc(self, center, radius, start, end, **style):
        """Draws an arc between two angles (radians), counter-clockwise if `end` is the larger
        one."""
        self.path("M" + self.place(on_circle(center, radius, start)) +
                  self.arc_data(center, radius, start, end), **style)

    def sector(self, center, inner, outer, start, end, **style):
        """Draws the region between two arcs about the same centre."""
        self.path("M" + self.place(on_circle(center, outer, start)) +
                  self.arc_data(center, outer, start, end) +
                  "L" + self.place(on_circle(center, inner, end)) +
                  self.arc_data(center, inner, end, start) + "Z", **style)

    def arrow(self, start, end, color=BLACK, width=1.5):
        self.lines([start, end], stroke=color, width=width)
        (x0, y0), (x1, y1) = self.page(start), self.page(end)
        length = math.hypot(x1 - x0, y1 - y0)
        ux, uy = (x1 - x0) / length, (y1 - y0) / length
        corners = [(x1, y1), (x1 - 8 * ux - 3.5 * uy, y1 - 8 * uy + 3.5 * ux),
                   (x1 - 8 * ux + 3.5 * uy, y1 - 8 * uy - 3.5 * ux)]
        data = "M" + "L".join(f"{number(x)} {number(y)}" for x, y in corners) + "Z"
        self.path(data, fill=color)

    def label(self, point, text, offset=(0, 0), **how):
        """Draws a label. `offset` is in pixels, to the right and upwards."""
        x, y = self.page(point)
        self.diagram.label(x + offset[0], y - offset[1], text, **how)
