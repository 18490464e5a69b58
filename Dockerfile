# The server with its page, built by the same commands as `./dev run`.
#   docker build -t stepramp .
#   docker run --rm --network host --volume stepramp:/data --device /dev/ttyACM0 --group-add dialout stepramp
# The server listens on 127.0.0.1 only, so the container shares the host's network; leave --device out without a board.
# The library, the backups of controllers and the audit log are in the volume. With PostgreSQL: compose.yaml.
FROM python:3.12-slim

WORKDIR /opt/stepramp
COPY dev mkdocs.yml pyproject.toml *.md LICENSE ./
COPY requirements requirements
COPY backend backend
COPY frontend frontend
COPY docs docs
COPY firmware/README.md firmware/README.md
RUN ./dev install \
  && .venv/bin/pip install --no-cache-dir --disable-pip-version-check --quiet --constraint requirements/test.txt "psycopg[binary]" \
  && useradd --create-home --uid 1000 stepramp \
  && install --directory --owner=stepramp --group=stepramp /data

# Compiled numerics are kept where the user may write.
ENV NUMBA_CACHE_DIR=/home/stepramp/.cache/numba STEPRAMP_DATA=/data
USER 1000
VOLUME /data
EXPOSE 8000
# It asks wherever the server listens, over TLS if it has a certificate: the note that it leaves in /data tells.
HEALTHCHECK --interval=30s --timeout=5s --start-period=20s \
  CMD [".venv/bin/python", "-c", "from stepramp.client.health import are_well; raise SystemExit(not are_well())"]
ENTRYPOINT [".venv/bin/stepramp", "serve", "--no-browser"]
