"""What one needs to know before a machine is trusted with steel: looked over, measured, judged."""

from fraese.doctor.examination import Diagnosis, admit, examine

__all__ = ["Diagnosis", "admit", "examine"]
