# The names of `import geofit`, one line each: types for editors, and the table of what is imported when first used.
from geofit import io as io
from geofit.data import errors as errors
from geofit.data.errors import GeofitError as GeofitError
from geofit.data.points import PointSet as PointSet
from geofit.data.settings import FitSettings as FitSettings
from geofit.data.site import Site as Site
from geofit.fitting.edit import adjust as adjust
from geofit.fitting.edit import pull_to as pull_to
from geofit.fitting.edit import weigh as weigh
from geofit.fitting.horizon_fit import HorizonFit as HorizonFit
from geofit.fitting.judge import judge as judge
from geofit.fitting.pipeline import fit_horizon as fit_horizon
from geofit.io.export.write import write_surface as write_surface
from geofit.io.picks import read_points as read_points
from geofit.io.site_file import read_site as read_site
from geofit.io.surface_files import read_surface as read_surface
from geofit.prediction.bands import band as band
from geofit.prediction.bands import prediction_sd as prediction_sd
from geofit.prediction.examine import examine as examine
from geofit.project.write_report import write_report as write_report
from geofit.sampling.contours import contours as contours
from geofit.sampling.cut import cut_section as cut_section
from geofit.site.fault_blocks import fit_blocks as fit_blocks
from geofit.site.fit_site import fit_site as fit_site
from geofit.site.order import compare_horizons as compare_horizons
from geofit.site.order import thickness as thickness
from geofit.site.separate import separate_horizons as separate_horizons

__version__: str
