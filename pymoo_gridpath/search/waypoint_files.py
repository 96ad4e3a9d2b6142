"""The texts of files of waypoints."""

from __future__ import annotations

import math

import numpy as np
import yaml


def csv_text(points: np.ndarray, yaw: np.ndarray) -> str:
    """Return ``x,y,yaw`` in full precision, a point a line."""
    rows = zip(*points.T.tolist(), yaw.tolist(), strict=True)
    return "".join(f"{','.join(map(str, row))}\n" for row in [("x", "y", "yaw"), *rows])


def nav_path_text(points: np.ndarray, yaw: np.ndarray, frame_id: str) -> str:
    """Return nav_msgs/Path of ROS 2 as YAML, with plain numbers and no anchors."""
    poses = [
        {
            "header": _header(frame_id),
            "pose": {
                "position": {"x": x, "y": y, "z": 0.0},
                "orientation": {"x": 0.0, "y": 0.0, "z": math.sin(angle / 2), "w": math.cos(angle / 2)},
            },
        }
        for (x, y), angle in zip(points.tolist(), yaw.tolist(), strict=True)
    ]
    return yaml.safe_dump({"header": _header(frame_id), "poses": poses}, sort_keys=False, allow_unicode=True)


def _header(frame_id: str) -> dict:
    # A new one each time: of the same one, YAML would write a reference.
    return {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": frame_id}


def f1tenth_text(points: np.ndarray, yaw: np.ndarray, speed: float) -> str:
    """Return a racing line of F1TENTH at one speed."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    curvature = np.zeros(len(points))
    curvature[1:-1] = signed_curvature(points)
    columns = along, *points.T, np.remainder(yaw, 2 * math.pi), curvature, np.full(len(points), speed), np.zeros(len(points))
    rows = zip(*(column.tolist() for column in columns), strict=True)
    # Readers skip three lines, or those that begin with a #.
    head = "# waypoints of a path\n# at one speed\n# s_m; x_m; y_m; psi_rad; kappa_radpm; vx_mps; ax_mps2\n"
    return head + "".join(f"{';'.join(map(str, row))}\n" for row in rows)


def signed_curvature(points: np.ndarray) -> np.ndarray:
    """Return Menger's curvature, that of the circle through three points, at all but the ends, positive to the left."""
    if len(points) < 3:
        return np.zeros(0)
    before, after, both = points[1:-1] - points[:-2], points[2:] - points[1:-1], points[2:] - points[:-2]
    product = np.hypot(*before.T) * np.hypot(*after.T) * np.hypot(*both.T)
    twice = 2.0 * (before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0])
    return np.divide(twice, product, out=np.zeros(len(product)), where=product > 0)
