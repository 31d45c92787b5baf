"""``mpm-lab bench --waits``: what people wait for, in this code and, beside it in turns, in another folder of it.

``checkout`` is a folder that the lab runs from; ``commands``, ``page`` and ``visits`` measure one, each a kind of
wait: command lines, a browser that opens the page, visitors without one; ``turns`` takes turns and makes the rows,
``text`` the table of them. ``chromium`` speaks to a browser.
"""
