# fibertwin with OpenFOAM on Debian. docs/installing.md says how far it was tried: every step but by Docker itself.
FROM debian:bookworm-slim
RUN apt-get update \
 && apt-get install --yes --no-install-recommends python3 python3-venv openfoam openmpi-bin libgl1 libegl1 libgl1-mesa-dri libxrender1 \
 && rm -rf /var/lib/apt/lists/*
# HOME: a container that is run as somebody else (--user) has none, and libraries keep their settings there
ENV WM_PROJECT_DIR=/usr/share/openfoam PATH=/opt/fibertwin/bin:$PATH HOME=/tmp
COPY . /src
RUN python3 -m venv /opt/fibertwin \
 && /opt/fibertwin/bin/pip install --no-cache-dir --constraint /src/constraints.txt /src \
 && rm -rf /src
# MPI refuses to run as root
RUN useradd --create-home engineer
USER engineer
WORKDIR /work
ENTRYPOINT ["fibertwin"]
CMD ["--help"]
