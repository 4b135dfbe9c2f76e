"""Ctrl-C ends long work, and other threads go on meanwhile."""

import subprocess
import sys
import threading
import time


import qcar


def test_a_long_fit_ends_with_keyboard_interrupt(campaigns):
    # A process of its own, since what it is sent goes to its main thread.
    program = f"""
import _thread, threading, time
import qcar
threading.Timer(1.0, _thread.interrupt_main).start()
try:
    qcar.fit({str(campaigns / "axle_a_rig")!r}, starts=10000)
except KeyboardInterrupt:
    print("interrupted")
    print(qcar.fit({str(campaigns / "axle_a_rig")!r}).converged)
"""
    ran = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=300)
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
