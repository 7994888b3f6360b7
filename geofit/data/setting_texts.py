"""What each setting of a fit is called, what it does, its unit and its choices: described once, read everywhere.

The panels, the command line, the report, ``docs/settings.md`` and the errors of
:class:`~geofit.data.settings.FitSettings` and :class:`~geofit.bodies.settings.BodySettings` take their words and ranges
from here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from geofit.data.messages import Message, message

__all__ = ["BODY_SETTINGS", "SETTINGS", "SettingText"]


@dataclass(frozen=True)
class SettingText:
    """A setting in words.

    Parameters
    ----------
    label : Message
        Its name.
    about : Message
        What it does, in one or two sentences.
    unit : str
        Unit of a number, empty without one.
    choices : mapping
        Words for values that are not numbers.
    number : {"", "real", "whole"}
        Which numbers it accepts in addition to the choices: none, real or whole ones.
    least : int, optional
        The smallest whole number that it takes; real numbers must be above 0.
    """

    label: Message
    about: Message
    unit: str = ""
    choices: Mapping[object, Message] = field(default_factory=dict)
    number: Literal["", "real", "whole"] = ""
    least: int = 0

    def with_unit(self) -> Message:
        """Return the name with the unit, as a table has it."""
        if not self.unit:
            return self.label
        return message("data.setting-label-unit", "{label}, {unit}", label=self.label, unit=self.unit)


_AUTO = message("data.setting-automatic", "Automatic")

#: Every field of :class:`~geofit.data.settings.FitSettings`, in the order of the fit panel.
SETTINGS: Mapping[str, SettingText] = {
    "epsilon": SettingText(
        message("data.setting-epsilon", "Control error ε"),
        message(
            "data.setting-epsilon-about",
            "The surface passes when σ, the standard deviation of all points from it, is below this.",
        ),
        "m",
        number="real",
    ),
    "interior_tolerance": SettingText(
        message("data.setting-interior-tolerance", "Interior tolerance"),
        message(
            "data.setting-interior-tolerance-about",
            "How far a point outside the core may lie from the surface. The fit refines until the limit is met or "
            "refinement no longer helps.",
        ),
        "m",
        number="real",
    ),
    "core": SettingText(
        message("data.setting-core", "Exact core"),
        message(
            "data.setting-core-about",
            "The region whose points the surface interpolates exactly. Automatic: where the points are dense. All: "
            "every point. None: all points are approximated, except on folds. Drawn: the rectangle around a polygon.",
        ),
        choices={
            "auto": _AUTO,
            "all": message("data.setting-core-all", "All points"),
            "none": message("data.setting-core-none", "None"),
        },
    ),
    "smoothing": SettingText(
        message("data.setting-smoothing", "Smoothing"),
        message(
            "data.setting-smoothing-about",
            "Weight of the bending energy outside the core. Automatic: from the scatter of the points. Larger is "
            "smoother, smaller is nearer to the points.",
        ),
        choices={"auto": _AUTO},
        number="real",
    ),
    "boundary_tolerance": SettingText(
        message("data.setting-boundary-tolerance", "Seam tolerance"),
        message(
            "data.setting-boundary-tolerance-about",
            "The largest gap allowed between the edges of neighbouring patches. Patches of a fit share their edges: no "
            "gap.",
        ),
        "m",
        number="real",
    ),
    "across": SettingText(
        message("data.setting-across", "Across sections"),
        message(
            "data.setting-across-about",
            "How the core runs from one section to the next: lofted smoothly, or ruled along straight lines.",
        ),
        choices={
            "cubic": message("data.setting-across-cubic", "Cubic"),
            "linear": message("data.setting-across-linear", "Linear"),
        },
    ),
    "seam": SettingText(
        message("data.setting-seam", "At the seams"),
        message(
            "data.setting-seam-about",
            "Whether neighbouring patches share a tangent plane, or meet at the edge and may break there.",
        ),
        choices={
            "tangent": message("data.setting-seam-tangent", "Smooth"),
            "position": message("data.setting-seam-position", "Break allowed"),
        },
    ),
    "frame": SettingText(
        message("data.setting-frame", "Parametrized over"),
        message(
            "data.setting-frame-about",
            "Map: one height at each place. Best plane: for steep faults. Sections: for overturned folds, through the "
            "section lines in order.",
        ),
        choices={
            "auto": _AUTO,
            "map": message("data.setting-frame-map", "The map"),
            "best-plane": message("data.setting-frame-best-plane", "Its best plane"),
            "sections": message("data.setting-frame-sections", "Its sections"),
        },
    ),
    "robust": SettingText(
        message("data.setting-robust", "Outliers"),
        message(
            "data.setting-robust-about",
            "Peripheral points that their neighbours contradict. They are listed and count in sigma either way.",
        ),
        choices={
            False: message("data.setting-robust-false", "Fitted too"),
            True: message("data.setting-robust-true", "Not fitted"),
        },
    ),
    "strict": SettingText(
        message("data.setting-strict", "Beyond tolerance"),
        message(
            "data.setting-strict-about",
            "Peripheral points farther from the surface than the interior tolerance: listed where noise explains them "
            "or neighbours contradict them, or met in any case, at the price of swings between them.",
        ),
        choices={
            False: message("data.setting-strict-false", "Listed where noise explains them"),
            True: message("data.setting-strict-true", "Met where knots allow"),
        },
    ),
    "dips": SettingText(
        message("data.setting-dips", "Measured dips"),
        message(
            "data.setting-dips-about",
            "Check: dips measured on the horizon are compared with the surface. Fit: they are also data, and the "
            "surface follows their slope within their accuracy.",
        ),
        choices={
            "check": message("data.checked", "Checked"),
            "fit": message("data.setting-dips-fit", "Checked and fitted"),
        },
    ),
    "dip_accuracy": SettingText(
        message("data.setting-dip-accuracy", "Accuracy of dips"),
        message(
            "data.setting-dip-accuracy-about",
            "Standard deviation of a measured dip about the surface's own, the waviness of the bed included.",
        ),
        "°",
        number="real",
    ),
    "max_iterations": SettingText(
        message("data.setting-max-iterations", "Rounds, at most"),
        message(
            "data.setting-max-iterations-about",
            "How often the fit may refine and adjust before it stops and reports what is not met.",
        ),
        number="whole",
    ),
    "max_control_points": SettingText(
        message("data.setting-max-control-points", "Control points, at most"),
        message(
            "data.setting-max-control-points-about",
            "Limit of the surface's size. Automatic: 40 a data point, 15 with a core, between 1,600 and 20,000, and as "
            "many as it takes to interpolate the core or, without one, to meet the points, up to 120,000.",
        ),
        choices={None: _AUTO},
        number="whole",
        least=16,
    ),
    "coincidence_distance": SettingText(
        message("data.setting-coincidence-distance", "Coincidence distance"),
        message(
            "data.setting-coincidence-distance-about",
            "Points closer than this in plan are coincident. If their elevations differ, the more accurate one is used "
            "and the other listed.",
        ),
        "m",
        number="real",
    ),
}

#: Every field of :class:`~geofit.bodies.settings.BodySettings`, in the order of the panel of bodies.
BODY_SETTINGS: Mapping[str, SettingText] = {
    "epsilon": SettingText(
        message("data.setting-epsilon", "Control error ε"),
        message(
            "data.setting-body-epsilon-about",
            "The body passes when σ, the standard deviation of its contacts from the surface, is below this.",
        ),
        "m",
        number="real",
    ),
    "step": SettingText(
        message("data.setting-step", "Sample spacing"),
        message(
            "data.setting-step-about",
            "Distance between samples along logged intervals. Automatic: a quarter of the median interval in the body.",
        ),
        "m",
        {None: _AUTO},
        number="real",
    ),
    "closed": SettingText(
        message("data.setting-closed", "Far from data"),
        message(
            "data.setting-closed-about",
            "Outside: ground beyond the reach of all contacts and inside samples is not in the body, so that it "
            "closes. Unknown: the body may continue there.",
        ),
        choices={
            True: message("data.setting-closed-true", "Outside"),
            False: message("data.setting-closed-false", "Unknown"),
        },
    ),
    "reach": SettingText(
        message("data.setting-reach", "Reach"),
        message(
            "data.setting-reach-about",
            "How far from contacts and inside samples the body may extend. Automatic: twice the distance between "
            "holes.",
        ),
        "m",
        {None: _AUTO},
        number="real",
    ),
    "ranges": SettingText(
        message("data.setting-ranges", "Ranges"),
        message(
            "data.setting-ranges-about",
            "How far data act along the major, the middle and the minor axis, relative to each other: 3 3 1 for a "
            "flat lens.",
        ),
    ),
    "azimuth": SettingText(
        message("data.setting-azimuth", "Dip direction"),
        message(
            "data.setting-azimuth-about",
            "Direction towards which the plane of the major and middle axes dips, clockwise from grid north.",
        ),
        "°",
    ),
    "dip": SettingText(
        message("data.setting-dip", "Dip"),
        message("data.setting-dip-about", "Dip of the plane of the major and middle axes."),
        "°",
    ),
    "rake": SettingText(
        message("data.setting-rake", "Rake"),
        message(
            "data.setting-rake-about",
            "Angle in that plane from the line of steepest descent to the major axis, clockwise seen from above.",
        ),
        "°",
    ),
    "box": SettingText(
        message("data.setting-box", "Box"),
        message(
            "data.setting-box-about",
            "Lower and upper corner at which the body is cut, six map coordinates in metres. Empty: the box of the "
            "data, enlarged by 1.1 times the reach.",
        ),
        choices={None: _AUTO},
    ),
    "coincidence_distance": SettingText(
        message("data.setting-coincidence-distance", "Coincidence distance"),
        message("data.setting-body-coincidence-about", "Contacts and samples closer than this to each other are one."),
        "m",
        number="real",
    ),
    "kernel": SettingText(
        message("data.setting-kernel", "Kernel"),
        message(
            "data.setting-kernel-about",
            "Radial function of the field. r³ is smooth. r follows the data more tightly, has a kink at each contact "
            "and takes no normals.",
        ),
        choices={
            "r3": message("data.setting-kernel-cubic", "r³, smooth"),
            "r": message("data.setting-kernel-linear", "r, tight"),
        },
    ),
    "dense": SettingText(
        message("data.setting-dense", "Conditions at once"),
        message(
            "data.setting-dense-about",
            "Largest number of conditions that are solved at once; more are solved in overlapping parts.",
        ),
        number="whole",
        least=50,
    ),
    "realizations": SettingText(
        message("data.setting-realizations", "Simulations"),
        message(
            "data.setting-realizations-about", "Number of conditional simulations behind the volumes P10, P50 and P90."
        ),
        number="whole",
        least=10,
    ),
    "seed": SettingText(
        message("data.setting-seed", "Seed"),
        message(
            "data.setting-seed-about",
            "Start of the random numbers of the simulations: the same seed, the same volumes.",
        ),
        number="whole",
    ),
}
