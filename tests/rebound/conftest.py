"""Makes the modules of this folder importable whatever folder pytest is called from."""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))
