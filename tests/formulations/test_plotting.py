import subprocess
import sys


def test_the_face_shows_the_way_and_loads_nothing_for_it():
    code = (
        "import sys\nfrom waybound.formulations import plotting\nassert callable(plotting.draw)\n"
        "print(sorted({'numpy', 'pandas', 'matplotlib', 'waybound.reports'} & set(sys.modules)))"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip() == "[]"
