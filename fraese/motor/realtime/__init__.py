"""The polled core in a process of its own, so that nothing in the app can delay a step.

    app's process                      shared memory                      the child
    RealtimeDriver --blocks----------> ring of records ----------------> Chores --> MotorCore
          |        --brake, stop-----> words -----------------> RealtimeClock --'       |
          |        --flush, idle, ...> mailbox --------------------------> Chores       v
          '<-------reports------------ one record with a sequence lock <- Reporter     port

Linux only: nothing outside imports it but who puts a machine together.
"""
