"""Executors of the user: how many points are out where `in_flight` is not given."""

import multiprocessing
import os
import threading
import time
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing.pool import ThreadPool

import evaluations
import pytest
import satisfice
from satisfice._workers import assumed_workers

SQUARE = [(-2, 2), (-2, 2)]
RING = {"delta": 0.05, "separation": 0.1, "evaluations": 60, "seed": 1}


class Counted:
    """An executor that counts what is out, and says nothing of its workers. It begins to work when `expected` are out."""

    def __init__(self, expected):
        self.out, self.most, self.lock = 0, 0, threading.Lock()
        self.expected, self.begins = expected, threading.Event()

    def submit(self, f, *arguments):
        future = Future()
        with self.lock:
            self.out += 1
            self.most = max(self.most, self.out)
            if self.out == self.expected:
                self.begins.set()

        def work():
            self.begins.wait(5)
            time.sleep(0.005)
            with self.lock:
                self.out -= 1
            future.set_result(f(*arguments))

        threading.Thread(target=work, daemon=True).start()
        return future


class CountedThreads(ThreadPoolExecutor):
    """Threads that say how many they are."""

    most = 0

    def submit(self, f, *arguments):
        self.most = max(self.most, self._work_queue.qsize())
        return super().submit(f, *arguments)


def test_as_many_points_are_out_as_there_are_workers():
    with CountedThreads(3) as pool:
        report = satisfice.Search(SQUARE, **RING).run(evaluations.slow, executor=pool)
    assert report.evaluations == 60 and pool.most <= 2  # the rest is with a thread


def test_an_executor_that_does_not_say_has_a_worker_for_each_cpu():
    pool = Counted(os.cpu_count())
    satisfice.Search(SQUARE, **RING).run(evaluations.ring, executor=pool)
    assert pool.most == os.cpu_count()
    pool = Counted(7)
    satisfice.Search(SQUARE, **RING).run(evaluations.ring, executor=pool, in_flight=7)
    assert pool.most == 7


def test_executors_and_pools_say_how_many_they_are():
    with ThreadPoolExecutor(3) as threads, ProcessPoolExecutor(5) as processes, ThreadPool(4) as pool:
        assert [assumed_workers(one) for one in (threads, processes, pool)] == [3, 5, 4]
        assert [assumed_workers(one.map) for one in (threads, processes, pool)] == [3, 5, 4]
    with multiprocessing.Pool(2) as pool:
        assert assumed_workers(pool.imap) == 2
    assert assumed_workers(map) == 1
    assert assumed_workers(lambda f, points: map(f, points)) == os.cpu_count()


def test_dask_says_how_many_it_has():
    distributed = pytest.importorskip("distributed")
    options = {"n_workers": 3, "threads_per_worker": 1, "processes": False, "dashboard_address": None}
    with distributed.Client(**options) as client:
        assert assumed_workers(client.get_executor()) == 3
