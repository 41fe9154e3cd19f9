"""Reads a Palpate model folder and computes force and friction anywhere on its surface; model-file.md explains each step."""
import json, re
import numpy as np

unit = lambda v: np.array(v) / np.linalg.norm(v)
rotation = lambda w, *v: np.eye(3) + 2 * (w * np.cross(np.eye(3), v) + np.outer(v, v) - np.dot(v, v) * np.eye(3)) / (w * w + np.dot(v, v))
between = lambda a, b: rotation(1 + unit(a) @ unit(b), *np.cross(unit(a), unit(b)))  # the smallest that turns a into b
log = lambda r: (r - r.T)[[2, 0, 1], [1, 2, 0]] / 2 / np.sinc(np.arccos(np.clip((np.trace(r) - 1) / 2, -1, 1)) / np.pi)
matrix = lambda six: np.append(six, 0)[[[3, 4, 0], [4, 5, 1], [6, 6, 2]]]  # of a compliance: c and u, over 0, 0, u_z
def closest(triangles, point):  # where a point of the surface lies: the triangle, and the barycentric coordinates in it
    starts, sides = np.roll(triangles, 2, 1), np.roll(triangles, 1, 1) - np.roll(triangles, 2, 1)  # opposite to the corners
    normal = np.cross(sides[:, 0], sides[:, 1])[:, None]
    at = (np.cross(sides, point - starts) * normal).sum(2) / (normal * normal).sum(2)
    n, k = np.arange(len(at)), at.argmin(1)  # the side beyond which the point lies, if it lies outside
    t = np.clip(((point - starts[n, k]) * sides[n, k]).sum(1) / (sides[n, k] ** 2).sum(1), 0, 1)[:, None]
    at = np.where(at[n, k][:, None] < 0, (1 - t) * np.eye(3)[k - 2] + t * np.eye(3)[k - 1], at)
    triangle = np.nanargmin(np.linalg.norm((at[:, :, None] * triangles).sum(1) - point, axis=1))
    return triangle, at[triangle]
def local_force(contact, l):  # all in the local coordinates of the contact
    (weight, epsilon, *center), (ridge, offset, *slope) = (np.reshape(contact[kind], (-1, 5)).T for kind in ("bases", "ridges"))
    gradient = lambda x, s: x / np.sqrt((x * x).sum(0) + epsilon**2) @ weight + slope @ (s / np.hypot(s, 1) * ridge)
    return gradient(l[:, None] - center, l @ slope - offset) - gradient(-np.array(center), -offset)

class Model:
    def __init__(self, folder):
        header, body = open(f"{folder}/surface.ply", "rb").read().split(b"end_header\n", 1)
        self.vertices = np.frombuffer(body, "3<f8, 3<i4, 3<f8", int(re.search(rb"vertex (\d+)", header)[1]))
        self.corners = np.frombuffer(body[self.vertices.nbytes:], "u1, 3<i4")["f1"]
        self.triangles, document = self.vertices["f0"][self.corners], json.load(open(f"{folder}/field.json"))
        self.contacts, self.between = document["contacts"], document["interpolation"]
        for c in self.contacts:
            direction = c["compliance"]["direction"] if "compliance" in c else [0, 0, 1]
            c["frame"], c["pressing"] = rotation(*c["rotation"]), rotation(*c["rotation"]) @ between([0, 0, 1], direction)
            triangle, at = closest(self.triangles, c["position"])
            c["at"] = {v: b / at[at >= 1e-4].sum() for v, b in zip(self.corners[triangle], at) if b >= 1e-4}
    def weights(self, triangle, at):  # of contacts; a triangle is cut at the contacts in it, one after the other
        corners = list(self.corners[triangle])
        cuts = {i: c["at"] for i, c in enumerate(self.contacts) if len(c["at"]) > 1 and set(c["at"]) <= set(corners)}
        points = np.array([at] + [[cut.get(v, 0) for v in corners] for cut in cuts.values()])
        for row, contact in enumerate(cuts, 1):
            if points[row].min() >= -1e-7:  # it cuts the part that the place lies in; then coordinates in the smaller part
                k = min(np.flatnonzero(points[row] > 1e-7), key=lambda k: points[0, k] / points[row, k])
                corners[k], points = ~contact, points @ np.linalg.inv(np.where(np.arange(3)[:, None] == k, points[row], np.eye(3)))
        of = lambda v: np.bincount(self.vertices["f1"][v] + 1, self.vertices["f2"][v], len(self.contacts) + 1)[1:]
        rows = [np.arange(len(self.contacts)) == ~v if v < 0 else of(v) for v in corners]
        return [(w, c) for w, c in zip(points[0] @ rows, self.contacts) if w > 0]
    def evaluate(self, point, displacement):  # force on the object, friction coefficient, axis of the cone, friction axis
        triangle, at = closest(self.triangles, point)
        parts = self.weights(triangle, at)
        mean = lambda value, parts=parts: sum(w * value(c) for w, c in parts) / sum(w for w, c in parts)
        friction, axis = mean(lambda c: c["friction"]["coefficient"]), unit(mean(lambda c: unit(c["friction"]["axis"])))
        key = {"forces": "strength", "compliances": "compliance"}[self.between["rule"]]
        if known := [(w, c) for w, c in parts if key in c]:
            middle, place = mean(lambda c: np.array(c["position"]), known), at @ self.triangles[triangle]
            beyond = (place - middle) * min(1, self.between["reach"] / (np.linalg.norm(place - middle) or 1))
        def change_by(c, axes):  # what the trend of the contact adds at the point
            u, v = (middle - c["position"]) @ axes[:, :2], beyond @ axes[:, :2]
            s = np.outer(u, u) / 6 + np.outer(u, v) + np.outer(v, v) / 2
            return [*(2 / 3 * u + v), s[0, 0], s[0, 1] + s[1, 0], s[1, 1]] @ np.array(c[key]["trend"])
        if key == "strength":
            frame, strength = parts[0][1]["frame"], sum(w * c[key]["value"] for w, c in known)
            for _ in range(20): frame = frame @ rotation(2, *mean(lambda c: log(frame.T @ c["frame"])))
            change = sum(w * change_by(c, c["frame"]) for w, c in known) / strength if strength else 0
            scaled = lambda c: (1 + np.clip(change, -0.75, 0.75)) * local_force(c, frame.T @ displacement)
            return frame @ mean(scaled), friction, frame[:, 2], axis
        frame, here = between([0, 0, 1], mean(lambda c: c["pressing"][:, 2])), np.eye(3)
        turn = lambda c: frame.T @ between(c["pressing"][:, 2], frame[:, 2]) @ c["pressing"]
        own = lambda c: turn(c) @ matrix(c[key]["values"]) @ turn(c).T if key in c else here
        if known:
            here, change = mean(own, known), mean(lambda c: turn(c) @ matrix(change_by(c, c["pressing"])) @ turn(c).T, known)
            size = abs(np.trace(np.linalg.matrix_power(np.linalg.solve(here[:2, :2], change[:2, :2]), 2))) ** 0.5
            here = here + change * 0.75 / max(0.75, abs(change[2, 2]) / here[2, 2], size)
        def force_by(c):
            e, product, energy = own(c), own(c)[:2, :2] @ here[:2, :2], here[2, 2] / own(c)[2, 2]
            root = np.linalg.det(product) ** 0.5
            block = (product + root * np.eye(2)) @ np.linalg.inv(here[:2, :2]) / np.sqrt((np.trace(product) + 2 * root) * energy)
            warp = np.block([[block, (e[:2, 2:] - block @ here[:2, 2:]) / here[2, 2]], [np.zeros((1, 2)), 1 / energy]])
            to_local = c["frame"].T @ c["pressing"] @ turn(c).T @ warp @ frame.T
            return energy * to_local.T @ local_force(c, to_local @ displacement)
        return mean(force_by), friction, unit(mean(lambda c: c["frame"][:, 2])), axis
