"""A browser as the terminal: what Textual's driver for it does not do at a machine."""

from typing import Any

from textual.drivers.web_driver import WebDriver


class WebTerminal(WebDriver):
    """When who serves the app is gone, nobody can press the stop key any more."""

    def run_input_thread(self) -> None:
        """Hear, until there is nobody who speaks; the app did not want that."""
        super().run_input_thread()
        if not self.exit_event.is_set():
            app: Any = self._app
            app.terminal_is_gone()
