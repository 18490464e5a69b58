import subprocess
import sys


def test_the_package_is_a_command() -> None:
    told = subprocess.run([sys.executable, "-m", "stepramp", "--version"], check=True, capture_output=True, text=True)
    assert told.stdout.startswith("StepRamp 0.")
    command = [sys.executable, "-m", "stepramp", "--port", "many"]
    wrong = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (wrong.returncode, wrong.stdout) == (2, "")
    assert "--port is 'many'" in wrong.stderr
