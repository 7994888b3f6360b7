"""The base of dialogs with a long task and a 3D view of their own."""

from __future__ import annotations

from PySide6.QtGui import QCloseEvent

from geofit.gui.dialogs.task_dialog import TaskDialog
from geofit.gui.view3d.small_scene import SmallScene

__all__ = ["SceneDialog"]


class SceneDialog(TaskDialog):
    """A task dialog with a 3D view, ``scene``, which a subclass creates; it is closed however the dialog is left."""

    scene: SmallScene

    def closeEvent(self, event: QCloseEvent) -> None:  # noqa: N802
        """Stop what runs, and let go of the 3D view."""
        self.scene.close()
        super().closeEvent(event)

    def done(self, result: int) -> None:
        """Let go of the 3D view."""
        self.scene.close()
        super().done(result)
