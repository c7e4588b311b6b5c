"""Draws diagrams as SVG files with the standard library alone, and the surface of discs. The bytes are always the same.

Lengths on the page are in pixels. A panel maps scene coordinates, with y upwards, to the page.
Labels are plain text with $mathematics$: letters in italics, `_x` or `_{xyz}` as subscripts.
"""

import collections
import math
import re
import xml.sax.saxutils

# Colours of Okabe and Ito, which colour-blind readers can distinguish, and light tints of them.
BLUE, ORANGE, GREEN, PURPLE = "#0072B2", "#D55E00", "#009E73", "#9A5580"
LIGHT_BLUE, LIGHT_ORANGE, LIGHT_GREEN = "#D6E8F4", "#FBE3D3", "#D3EFE5"
BLACK, DARK, GREY, LIGHT = "#222222", "#444444", "#8A8A8A", "#ECECEC"

FONT_SIZE = 14
SUBSCRIPT_SIZE = 10.5
SPACE_WIDTH = 4.5
STEP = 0.06  # radians between the points of an arc


def number(value):
    text = f"{value:.1f}".removesuffix(".0")
    return "0" if text == "-0" else text


def angle_of(center, point):
    return math.atan2(point[1] - center[1], point[0] - center[0])


def on_circle(center, radius, angle):
    return center[0] + radius * math.cos(angle), center[1] + radius * math.sin(angle)


def on_arc(center, radius, start, end):
    """Returns points between two angles (radians), counter-clockwise if `end` is the larger one."""
    steps = max(1, math.ceil(abs(end - start) / STEP))
    return [on_circle(center, radius, start + (end - start) * step / steps) for step in range(steps + 1)]


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
            yield subscript.strip("{}") or other, True, bool(subscript)


def attributes(**values):
    return "".join(f' {name.replace("_", "-")}={xml.sax.saxutils.quoteattr(str(value))}'
                   for name, value in values.items() if value is not None)


def shape_style(stroke=None, fill="none", width=1.5, dash=None, opacity=None):
    return attributes(fill=fill, stroke=stroke, stroke_width=width if stroke else None, stroke_dasharray=dash,
                      fill_opacity=opacity)


class Diagram:
    def __init__(self, width, height, title):
        self.width, self.height, self.title = width, height, title
        self.elements = []

    def label(self, x, y, text, anchor="start", color=BLACK):
        """Writes a label with its vertical middle at `y`."""
        spans, lowered, space = "", 0, 0
        for part, is_italic, is_subscript in segments(text):
            wanted = 4 if is_subscript else 0
            # Renderers drop spaces at the ends of a part, so a shift replaces them.
            space += SPACE_WIDTH if part.startswith(" ") else 0
            style = attributes(
                dx=space or None, dy=wanted - lowered or None,
                font_style="italic" if is_italic and any(letter.isalpha() for letter in part) else None,
                font_size=SUBSCRIPT_SIZE if is_subscript else None)
            lowered, space = wanted, SPACE_WIDTH if part.endswith(" ") else 0
            spans += f"<tspan{style}>{xml.sax.saxutils.escape(part.strip())}</tspan>"
        place = attributes(x=number(x), y=number(y + 0.35 * FONT_SIZE), fill=color, text_anchor=anchor)
        self.elements.append(f"<text{place}>{spans}</text>")

    def text(self):
        head = attributes(xmlns="http://www.w3.org/2000/svg", width=self.width, height=self.height,
                          viewBox=f"0 0 {self.width} {self.height}",
                          font_family="DejaVu Sans, Verdana, Arial, sans-serif", font_size=FONT_SIZE, role="img")
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

    def circle(self, center, radius, **style):
        x, y = self.page(center)
        place = attributes(cx=number(x), cy=number(y), r=number(radius * self.scale))
        self.diagram.elements.append(f"<circle{place}{shape_style(**style)}/>")

    def dot(self, center, color=BLACK, pixels=3.5, is_hollow=False):
        style = {"stroke": color, "fill": "#FFFFFF"} if is_hollow else {"fill": color}
        self.circle(center, pixels / self.scale, **style)

    def lines(self, points, is_closed=False, **style):
        data = "L".join(" ".join(map(number, self.page(point))) for point in points) + ("Z" if is_closed else "")
        self.diagram.elements.append(f'<path d="M{data}"{shape_style(**style)}/>')

    def rectangle(self, low, high, **style):
        self.lines([low, (high[0], low[1]), high, (low[0], high[1])], is_closed=True, **style)

    def arc(self, center, radius, start, end, **style):
        self.lines(on_arc(center, radius, start, end), **style)

    def arrow(self, start, end, color=BLACK, width=1.5):
        self.lines([start, end], stroke=color, width=width)
        length, half = 8 / self.scale, 3.5 / self.scale  # of the head
        x, y = toward(end, start, length)
        ux, uy = (half * (b - a) / math.dist(start, end) for a, b in zip(start, end))
        self.lines([end, (x - uy, y + ux), (x + uy, y - ux)], is_closed=True, fill=color)

    def label(self, point, text, offset=(0, 0), **how):
        """Draws a label. `offset` is in pixels, to the right and upwards."""
        x, y = self.page(point)
        self.diagram.label(x + offset[0], y - offset[1], text, **how)


# ------------------------------------------------------------------------------- surface of discs

# An accessible arc of the SAS circle of one disc, counter-clockwise between two angles.
Face = collections.namedtuple("Face", "disc start end")


class DiscSurface:
    """The solvent excluded surface of discs in a plane, in place of spheres. `discs` are (x, y, radius). The
    accessible set is bounded by arcs of SAS circles, which meet at vertices, where the probe touches two
    discs."""

    def __init__(self, discs, probe):
        self.discs, self.probe = discs, probe
        self.faces = [face for disc in discs for face in self.faces_of(disc)]

    def ends_on(self, disc):
        """Returns the angles at which other SAS circles meet that of the disc."""
        radius = disc[2] + self.probe
        for other in self.discs:
            distance, reach = math.dist(disc[:2], other[:2]), other[2] + self.probe
            if other is disc or distance >= radius + reach:
                continue
            middle = angle_of(disc, other)
            half = math.acos((distance ** 2 + radius ** 2 - reach ** 2) / (2 * distance * radius))
            yield (middle - half) % math.tau
            yield (middle + half) % math.tau

    def faces_of(self, disc):
        """Returns the arcs whose middles are in no other SAS circle. At each end the other circle covers one
        side, so faces do not touch each other."""
        ends = sorted(self.ends_on(disc)) or [0]
        arcs = [Face(disc, start, end) for start, end in zip(ends, ends[1:] + [ends[0] + math.tau])]
        return [face for face in arcs
                if all(math.dist(on_circle(disc, disc[2] + self.probe, (face.start + face.end) / 2), other[:2])
                       >= other[2] + self.probe for other in self.discs if other is not disc)]

    def ends_of(self, face):
        return [on_circle(face.disc, face.disc[2] + self.probe, angle) for angle in (face.start, face.end)]

    def vertex_behind(self, face):
        return self.ends_of(face)[1]

    def loop(self, first):
        """Returns the faces around one component of the boundary, beginning with `first`."""
        faces = [first]
        while (face := self.next_face(faces[-1])) is not first:
            faces.append(face)
        return faces

    def next_face(self, face):
        vertex = self.vertex_behind(face)
        return min(self.faces, key=lambda other: math.dist(vertex, self.ends_of(other)[0]))

    def sas(self, faces):
        """Returns points on the SAS along a loop."""
        return [point for face in faces for point in on_arc(face.disc, face.disc[2] + self.probe, face.start, face.end)]

    def contact_angles(self, face):
        """Returns where the probe at the end of a face touches its disc and the next one, as
        seen from the probe."""
        vertex = self.vertex_behind(face)
        first, second = (angle_of(vertex, disc) for disc in (face.disc, self.next_face(face).disc))
        return first, second if second <= first else second - math.tau  # clockwise

    def ses(self, faces):
        """Returns points on the solvent excluded surface along a loop."""
        return [point for face in faces
                for point in [*on_arc(face.disc, face.disc[2], face.start, face.end),
                              *on_arc(self.vertex_behind(face), self.probe, *self.contact_angles(face))]]
