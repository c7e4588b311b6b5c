"""The solvent excluded surface of discs in a plane, for diagrams.

Circles replace the spheres of space. The accessible set is bounded by arcs of SAS circles,
which meet at vertices, where the probe touches two discs.
"""

import math

from diagrams import on_circle

FULL_TURN = 2 * math.pi


class Face:
    """An accessible arc of the SAS circle of one disc, counter-clockwise between two angles."""

    def __init__(self, disc, start, end):
        self.disc, self.start, self.end = disc, start, end


class DiscSurface:
    """The surface of discs. `discs` are (x, y, radius)."""

    def __init__(self, discs, probe):
        self.discs, self.probe = discs, probe
        self.faces = [face for disc in discs for face in self.faces_of(disc)]

    def sas_radius(self, disc):
        return disc[2] + self.probe

    def is_accessible(self, point, apart_from):
        return all(math.dist(point, disc[:2]) >= self.sas_radius(disc)
                   for disc in self.discs if disc is not apart_from)

    def ends_on(self, disc):
        """Returns the angles at which other SAS circles meet that of the disc."""
        radius = self.sas_radius(disc)
        for other in self.discs:
            distance = math.dist(disc[:2], other[:2])
            if other is disc or distance >= radius + self.sas_radius(other):
                continue
            height = (distance ** 2 + radius ** 2 - self.sas_radius(other) ** 2) / (2 * distance)
            middle = math.atan2(other[1] - disc[1], other[0] - disc[0])
            half = math.acos(height / radius)
            yield (middle - half) % FULL_TURN
            yield (middle + half) % FULL_TURN

    def faces_of(self, disc):
        ends = sorted(self.ends_on(disc))
        if not ends:
            return [Face(disc, 0, FULL_TURN)]
        # At each end the other circle covers one side, so faces do not touch each other.
        return [Face(disc, start, end)
                for start, end in zip(ends, ends[1:] + [ends[0] + FULL_TURN])
                if self.is_accessible(on_circle(disc[:2], self.sas_radius(disc),
                                                (start + end) / 2), apart_from=disc)]

    def vertex_behind(self, face):
        return on_circle(face.disc[:2], self.sas_radius(face.disc), face.end)

    def next_face(self, face):
        vertex = self.vertex_behind(face)
        return min(self.faces, key=lambda other: math.dist(vertex, on_circle(
            other.disc[:2], self.sas_radius(other.disc), other.start)))

    def loop(self, first):
        """Returns the faces around one component of the boundary, beginning with `first`."""
        faces = [first]
        while (face := self.next_face(faces[-1])) is not first:
            faces.append(face)
        return faces

    def sas_data(self, panel, faces):
        """Returns the SAS along a loop, as data of a path."""
        data = "M" + panel.place(on_circle(faces[0].disc[:2], self.sas_radius(faces[0].disc),
                                           faces[0].start))
        for face in faces:
            data += panel.arc_data(face.disc[:2], self.sas_radius(face.disc), face.start, face.end)
        return data + "Z"

    def contact_angles(self, face):
        """Returns where the probe at the end of a face touches its disc and the next one, as
        seen from the probe."""
        vertex, after = self.vertex_behind(face), self.next_face(face)
        angles = [math.atan2(disc[1] - vertex[1], disc[0] - vertex[0])
                  for disc in (face.disc, after.disc)]
        if angles[1] > angles[0]:
            angles[1] -= FULL_TURN  # clockwise
        return angles

    def ses_data(self, panel, faces):
        """Returns the solvent excluded surface along a loop, as data of a path."""
        data = "M" + panel.place(on_circle(faces[0].disc[:2], faces[0].disc[2], faces[0].start))
        for face in faces:
            data += panel.arc_data(face.disc[:2], face.disc[2], face.start, face.end)
            data += panel.arc_data(self.vertex_behind(face), self.probe,
                                   *self.contact_angles(face))
        return data + "Z"
