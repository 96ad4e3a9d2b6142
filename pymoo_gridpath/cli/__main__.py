"""``python -m pymoo_gridpath.cli`` is the command ``pymoo-gridpath``."""

import sys

from pymoo_gridpath.cli.main import main

sys.exit(main())
