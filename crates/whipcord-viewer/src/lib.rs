//! The viewer of whipcord: a robot in a page of the browser, with a slider for each cable.
//!
//! A server on this machine reads a robot file, follows its changes, and solves what the sliders of the page say, over
//! a WebSocket ([`protocol`]). The page is TypeScript in `page/`; built by Node, it is part of this crate's
//! binary. Without it everything here compiles, and [`View::open`] says what to do.

mod answer;
mod background;
mod bench;
mod beside;
mod connection;
mod convert;
mod courses;
mod design;
mod error;
mod export;
mod grid;
mod history;
mod holes;
mod inverse;
mod loads;
mod measured;
mod obstacles;
mod opened;
mod page;
mod play;
pub mod protocol;
mod ranges;
mod scene;
mod server;
mod stations;
mod stock;
mod stream;
mod survey;
#[cfg(test)]
mod tests;

use std::fmt::Display;
use std::io::BufRead;
use std::path::Path;

use whipcord::ModelPreset;

use crate::beside::Beside;
use crate::history::History;
use crate::page::{Page, page};
use crate::server::{Server, Viewed};
use crate::stream::{Streamed, follow};

pub use error::ViewError;
pub use export::{Progress, export, export_workspace};
pub use scene::offered;

/// A robot file that is about to be viewed: it can be used, and the server listens.
#[derive(Debug)]
pub struct View {
    page: Page,
    viewed: Viewed,
    server: Server,
    runtime: tokio::runtime::Runtime,
}

impl View {
    /// Reads a robot file, and listens on a port of this machine, a free one for 0. The page begins with these models, or with
    /// the first that takes the robot.
    ///
    /// # Errors
    /// [`ViewError`] for a file that cannot be used, a model that does not take the robot, a port that is not to be had, and a
    /// binary without the page.
    pub fn open(path: &Path, models: &[ModelPreset], port: u16) -> Result<Self, ViewError> {
        let viewed = Viewed::read(path, models)?;
        let page = page()?;
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .enable_all()
            .build()
            .map_err(ViewError::Server)?;
        let server = runtime.block_on(Server::listen(port))?;
        Ok(Self { page, viewed, server, runtime })
    }

    /// Shows other robots beside that of the file, each as the first model that takes it has it.
    ///
    /// # Errors
    /// [`ViewError::File`] for a file that cannot be used.
    pub fn beside<'a>(
        mut self,
        paths: impl IntoIterator<Item = &'a Path>,
    ) -> Result<Self, ViewError> {
        self.viewed.beside = paths.into_iter().map(Beside::read).collect::<Result<_, _>>()?;
        Ok(self)
    }

    /// Shows the shapes that these lines say, each as it comes: one JSON object in each line, for the robot of the file and those
    /// beside it. A thread reads them until there are no more; what is wrong with a line is told to `complain`.
    ///
    /// # Errors
    /// [`ViewError::Server`] where there is no thread to be had.
    pub fn stream(
        &mut self,
        lines: impl BufRead + Send + 'static,
        complain: impl FnMut(&dyn Display) + Send + 'static,
    ) -> Result<(), ViewError> {
        let first = Streamed::new(&self.viewed.opened.usable.file);
        let others = self.viewed.beside.iter().map(|other| Streamed::new(&other.file));
        let robots: Vec<Streamed> = std::iter::once(first).chain(others).collect();
        let (tell, shown) = tokio::sync::watch::channel(History::default());
        self.viewed.shown = Some(shown);
        let thread = std::thread::Builder::new().name("stream".to_owned());
        thread
            .spawn(move || follow(lines, &robots, &tell, complain))
            .map(drop)
            .map_err(ViewError::Server)
    }

    /// Where the page is.
    #[must_use]
    pub fn url(&self) -> String {
        format!("http://127.0.0.1:{}/", self.server.port())
    }

    /// Shows the page in the browser; a machine without one is no error.
    pub fn show(&self) {
        // The address has been printed: whoever has no browser here can go there by hand.
        let _ = open::that_detached(self.url());
    }

    /// Serves the page for as long as the process lives.
    ///
    /// # Errors
    /// [`ViewError::Server`] when the server stops.
    pub fn serve(self) -> Result<(), ViewError> {
        let Self { page, viewed, server, runtime } = self;
        runtime.block_on(server.serve(page, viewed, std::future::pending()))
    }
}
