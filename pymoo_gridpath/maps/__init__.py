"""Maps: formats, one reader for each, the maps that ship with the package, and the queries that maps name.

`load_map` reads any of them. Readers return an `OccupancyGrid` and raise nothing but `MapError` for a bad file.
"""

# The order of the readers is that in which their formats are asked.
from pymoo_gridpath.maps._files import MAX_CELLS, check_size, make_grid, read_string
from pymoo_gridpath.maps.array import read_npy
from pymoo_gridpath.maps.formats import MAP_FORMATS, MapFormat, Query, format_of
from pymoo_gridpath.maps.geotiff import read_geotiff
from pymoo_gridpath.maps.image import read_image
from pymoo_gridpath.maps.load import load_map
from pymoo_gridpath.maps.movingai import ScenQuery, read_movingai, read_scen, read_terrain
from pymoo_gridpath.maps.queries import query_of
from pymoo_gridpath.maps.raster import read_raster
from pymoo_gridpath.maps.ros import read_ros
from pymoo_gridpath.maps.ros_message import grid_of_message, read_ros_message
from pymoo_gridpath.maps.rosbag import read_rosbag
from pymoo_gridpath.maps.save import save_map
from pymoo_gridpath.maps.shipped import ShippedMap, load_shipped, shipped_maps
from pymoo_gridpath.maps.text import TextHeader, read_text, read_text_header

__all__ = [
    "MAP_FORMATS",
    "MAX_CELLS",
    "MapFormat",
    "Query",
    "ScenQuery",
    "ShippedMap",
    "TextHeader",
    "check_size",
    "format_of",
    "grid_of_message",
    "load_map",
    "load_shipped",
    "make_grid",
    "query_of",
    "read_geotiff",
    "read_image",
    "read_movingai",
    "read_npy",
    "read_raster",
    "read_ros",
    "read_ros_message",
    "read_rosbag",
    "read_scen",
    "read_string",
    "read_terrain",
    "read_text",
    "read_text_header",
    "save_map",
    "shipped_maps",
]
