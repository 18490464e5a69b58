"""Write docs/openapi.json, the description of the REST API.

usage: python docs/make_openapi.py
"""

import json
from pathlib import Path

from stepramp.http_api.app import create_app

if __name__ == "__main__":
    text = json.dumps(create_app().openapi(), indent=1, ensure_ascii=False)
    Path(__file__).with_name("openapi.json").write_text(text + "\n", encoding="utf-8")
