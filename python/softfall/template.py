# SPDX-License-Identifier: GPL-3.0-or-later
"""Pages from the templates of share/softfall, and pictures for them."""
from __future__ import annotations

import base64
import io
from typing import Any

import jinja2

from . import programs


def png(figure: Any) -> bytes:
    """Returns a figure of matplotlib as a picture."""
    image = io.BytesIO()
    figure.savefig(image, format="png", metadata={"Software": None})
    return image.getvalue()


def base64_of(data: bytes) -> str:
    return base64.b64encode(data).decode()


def render(name: str, **values: Any) -> str:
    """Returns a page: the template with these values, and `css`, the style of all reports."""
    share = programs.folder().parent / "share/softfall"
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(share), autoescape=True, trim_blocks=True, lstrip_blocks=True, undefined=jinja2.StrictUndefined)
    environment.filters["base64"] = base64_of
    return environment.get_template(name).render(css=(share / "report.css").read_text(encoding="utf-8"), **values)
