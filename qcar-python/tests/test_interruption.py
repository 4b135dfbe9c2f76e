"""Ctrl-C ends long work, and other threads go on meanwhile."""

import subprocess
import sys
import threading
import time


import pytest

import qcar

#: What takes a second or more where nothing stops it, of which a tenth has passed when something does.
LONG = {
    "fit": 'qcar.fit("models/campaigns/axle_a_rig", starts=10000)',
    "frf": 'model.frf([1.0] * 1000, {"k_tire": [2e5] * 20000})',
    "rides": 'qcar.ride_metrics(model, {"k_tire": [2e5] * 10**7}, vehicle="models/campaigns/axle_c_study", speed=8.0, height=0.02)',
}


@pytest.mark.parametrize("long", LONG.values(), ids=LONG)
def test_long_work_ends_with_keyboard_interrupt(long, repository):
    # A process of its own, since what it is sent goes to its main thread. It goes on afterwards.
    program = f"""
import _thread, threading
import qcar
model = qcar.Model("quarter_car")
threading.Timer(0.1, _thread.interrupt_main).start()
try:
    {long}
except KeyboardInterrupt:
    print("interrupted")
    print(qcar.fit("models/campaigns/axle_a_rig").converged)
"""
    command = [sys.executable, "-c", program]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=500, cwd=repository)
    assert ran.stdout.split() == ["interrupted", "True"], ran.stderr


def test_other_threads_go_on_during_a_search(campaigns):
    ticks, over = [], threading.Event()

    def tick():
        while not over.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    qcar.fit(campaigns / "axle_a_rig", starts=30)
    over.set()
    thread.join()
    assert len(ticks) > 10
