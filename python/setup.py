"""Puts the texts of the message types beside the modules: they stand in lcmtypes/ of the repository."""
import pathlib
import shutil

from setuptools import setup
from setuptools.command.build_py import build_py


class BuildWithTypes(build_py):
    def run(self):
        super().run()
        folder = pathlib.Path(self.build_lib, 'lookout', 'lcmtypes')
        folder.mkdir(parents=True, exist_ok=True)
        for file in sorted(pathlib.Path(__file__).resolve().parents[1].glob('lcmtypes/*.lcm')):
            shutil.copy(file, folder)


setup(packages=['lookout'], cmdclass={'build_py': BuildWithTypes})
