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
        return message("settings.label-unit", "{label}, {unit}", label=self.label, unit=self.unit)


_AUTO = message("settings.automatic", "Automatic")

#: Every field of :class:`~geofit.data.settings.FitSettings`, in the order of the fit panel.
SETTINGS: Mapping[str, SettingText] = {
    "epsilon": SettingText(
        message("settings.epsilon", "Control error ε"),
        message(
            "settings.epsilon-about",
            "The surface passes when σ, the standard deviation of all points from it, is below this.",
        ),
        "m",
        number="real",
    ),
    "interior_tolerance": SettingText(
        message("settings.interior-tolerance", "Interior tolerance"),
        message(
            "settings.interior-tolerance-about",
            "How far a point outside the core may lie from the surface. The fit refines until the limit is met or "
            "refinement no longer helps.",
        ),
        "m",
        number="real",
    ),
    "core": SettingText(
        message("settings.core", "Exact core"),
        message(
            "settings.core-about",
            "The region whose points the surface interpolates exactly. Automatic: where the points are dense. All: "
            "every point. None: all points are approximated. Drawn: the rectangle around a polygon.",
        ),
        choices={
            "auto": _AUTO,
            "all": message("settings.core-all", "All points"),
            "none": message("settings.core-none", "None"),
        },
    ),
    "smoothing": SettingText(
        message("settings.smoothing", "Smoothing"),
        message(
            "settings.smoothing-about",
            "Weight of the bending energy outside the core. Automatic: from the scatter of the points. Larger is "
            "smoother, smaller is nearer to the points.",
        ),
        choices={"auto": _AUTO},
        number="real",
    ),
    "boundary_tolerance": SettingText(
        message("settings.boundary-tolerance", "Seam tolerance"),
        message(
            "settings.boundary-tolerance-about",
            "The largest gap allowed between the edges of neighbouring patches. Patches of a fit share their edges: no "
            "gap.",
        ),
        "m",
        number="real",
    ),
    "across": SettingText(
        message("settings.across", "Across sections"),
        message(
            "settings.across-about",
            "How the core runs from one section to the next: lofted smoothly, or ruled along straight lines.",
        ),
        choices={
            "cubic": message("settings.across-cubic", "Cubic"),
            "linear": message("settings.across-linear", "Linear"),
        },
    ),
    "seam": SettingText(
        message("settings.seam", "At the seams"),
        message(
            "settings.seam-about",
            "Whether neighbouring patches share a tangent plane, or meet at the edge and may break there.",
        ),
        choices={
            "tangent": message("settings.seam-tangent", "Smooth"),
            "position": message("settings.seam-position", "Break allowed"),
        },
    ),
    "frame": SettingText(
        message("settings.frame", "Parametrized over"),
        message(
            "settings.frame-about",
            "Map: one height at each place. Best plane: for steep faults. Sections: for overturned folds, through the "
            "section lines in order.",
        ),
        choices={
            "auto": _AUTO,
            "map": message("settings.frame-map", "The map"),
            "best-plane": message("settings.frame-best-plane", "Its best plane"),
            "sections": message("settings.frame-sections", "Its sections"),
        },
    ),
    "robust": SettingText(
        message("settings.robust", "Outliers"),
        message(
            "settings.robust-about",
            "Peripheral points that their neighbours contradict. They are listed and count in sigma either way.",
        ),
        choices={
            False: message("settings.robust-false", "Fitted too"),
            True: message("settings.robust-true", "Not fitted"),
        },
    ),
    "strict": SettingText(
        message("settings.strict", "Beyond tolerance"),
        message(
            "settings.strict-about",
            "Peripheral points farther from the surface than the interior tolerance: listed where noise explains them "
            "or neighbours contradict them, or met in any case, at the price of swings between them.",
        ),
        choices={
            False: message("settings.strict-false", "Listed where noise explains them"),
            True: message("settings.strict-true", "Met where knots allow"),
        },
    ),
    "dips": SettingText(
        message("settings.dips", "Measured dips"),
        message(
            "settings.dips-about",
            "Check: dips measured on the horizon are compared with the surface. Fit: they are data as well, and the "
            "surface takes their slope as far as their accuracy asks for it.",
        ),
        choices={
            "check": message("settings.dips-check", "Checked"),
            "fit": message("settings.dips-fit", "Checked and fitted"),
        },
    ),
    "dip_accuracy": SettingText(
        message("settings.dip-accuracy", "Accuracy of dips"),
        message(
            "settings.dip-accuracy-about",
            "Standard deviation of a measured dip about the surface's own, the waviness of the bed included.",
        ),
        "°",
        number="real",
    ),
    "max_iterations": SettingText(
        message("settings.max-iterations", "Rounds, at most"),
        message(
            "settings.max-iterations-about",
            "How often the fit may refine and adjust before it stops and reports what is not met.",
        ),
        number="whole",
    ),
    "max_control_points": SettingText(
        message("settings.max-control-points", "Control points, at most"),
        message(
            "settings.max-control-points-about",
            "Limit of the surface's size. Automatic: 40 a data point, 15 with a core, between 1,600 and 20,000, and as "
            "many as it takes to interpolate the core.",
        ),
        choices={None: _AUTO},
        number="whole",
        least=16,
    ),
    "coincidence_distance": SettingText(
        message("settings.coincidence-distance", "Coincidence distance"),
        message(
            "settings.coincidence-distance-about",
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
        message("settings.epsilon", "Control error ε"),
        message(
            "settings.body-epsilon-about",
            "The body passes when σ, the standard deviation of its contacts from the surface, is below this.",
        ),
        "m",
        number="real",
    ),
    "step": SettingText(
        message("settings.step", "Sample spacing"),
        message(
            "settings.step-about",
            "Distance between samples along logged intervals. Automatic: a quarter of the median interval in the body.",
        ),
        "m",
        {None: _AUTO},
        number="real",
    ),
    "closed": SettingText(
        message("settings.closed", "Far from data"),
        message(
            "settings.closed-about",
            "Outside: ground beyond the reach of all contacts and inside samples is not in the body, so that it "
            "closes. Unknown: the body may continue there.",
        ),
        choices={
            True: message("settings.closed-true", "Outside"),
            False: message("settings.closed-false", "Unknown"),
        },
    ),
    "reach": SettingText(
        message("settings.reach", "Reach"),
        message(
            "settings.reach-about",
            "How far from contacts and inside samples the body may extend. Automatic: twice the distance between "
            "holes.",
        ),
        "m",
        {None: _AUTO},
        number="real",
    ),
    "ranges": SettingText(
        message("settings.ranges", "Ranges"),
        message(
            "settings.ranges-about",
            "How far data act along the major, the middle and the minor axis, relative to each other: 3 3 1 for a "
            "flat lens.",
        ),
    ),
    "azimuth": SettingText(
        message("settings.azimuth", "Dip direction"),
        message(
            "settings.azimuth-about",
            "Direction towards which the plane of the major and middle axes dips, clockwise from grid north.",
        ),
        "°",
    ),
    "dip": SettingText(
        message("settings.dip", "Dip"),
        message("settings.dip-about", "Dip of the plane of the major and middle axes."),
        "°",
    ),
    "rake": SettingText(
        message("settings.rake", "Rake"),
        message(
            "settings.rake-about",
            "Angle in that plane from the line of steepest descent to the major axis, clockwise seen from above.",
        ),
        "°",
    ),
    "box": SettingText(
        message("settings.box", "Box"),
        message(
            "settings.box-about",
            "Lower and upper corner at which the body is cut, six map coordinates in metres. Empty: the box of the "
            "data, enlarged by 1.1 times the reach.",
        ),
        choices={None: _AUTO},
    ),
    "coincidence_distance": SettingText(
        message("settings.coincidence-distance", "Coincidence distance"),
        message("settings.body-coincidence-about", "Contacts and samples closer than this to each other are one."),
        "m",
        number="real",
    ),
    "dense": SettingText(
        message("settings.dense", "Conditions at once"),
        message(
            "settings.dense-about",
            "Largest number of conditions that are solved at once; more are solved in overlapping parts.",
        ),
        number="whole",
        least=50,
    ),
    "realizations": SettingText(
        message("settings.realizations", "Simulations"),
        message(
            "settings.realizations-about", "Number of conditional simulations behind the volumes P10, P50 and P90."
        ),
        number="whole",
        least=10,
    ),
    "seed": SettingText(
        message("settings.seed", "Seed"),
        message(
            "settings.seed-about", "Start of the random numbers of the simulations: the same seed, the same volumes."
        ),
        number="whole",
    ),
}
