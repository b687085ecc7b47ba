"""``python -m bench.campaign.wordhost PORT WORDS SEED``: a host that moves until it is killed."""

import random
import sys
from pathlib import Path

from fraese.motor.cards.smc1500 import SmcCard
from fraese.motor.ports.devport import DevPort
from fraese.motor.ports.ppdev import PpdevPort
from fraese.motor.realtime.driver import RealtimeDriver
from fraese.motor.realtime.lastwords import open_for
from fraese.motor.realtime.setup import Setup, WordsTo
from tests.motor.workbench import line

TOKEN = bytes(16)


def main(port: str, words: Path, seed: str) -> None:
    """Lines here and there; now and then a brake, a stop, or nothing to do."""
    chance = random.Random(seed)
    to = WordsTo(open_for(words), TOKEN)
    opened = PpdevPort if port == "ppdev" else DevPort
    driver = RealtimeDriver(Setup(opened, SmcCard(), last_words=to))
    print(driver.pid, flush=True)
    while True:
        driver.push(line(*(chance.randint(-900, 900) for _ in range(3))))
        report = driver.poll(chance.uniform(0, 0.2))
        if not chance.randrange(12):
            chance.choice((driver.brake, driver.stop))()
            while driver.poll(0.01).running:
                pass
            driver.flush()
        if report.held:
            driver.resume()


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]), sys.argv[3])
